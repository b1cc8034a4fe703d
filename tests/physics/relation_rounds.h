// Runs the rounds of a relation between two worlds (relations.h) with one method, each with a seed of its own.
#pragma once

#include <algorithm>

#include "tests/physics/relations.h"

namespace rivulet::relations {

using Relation = Found (*)(Device& device, const std::string& method, Dice& dice);
inline double median(std::vector<double> v) {
    std::nth_element(v.begin(), v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2), v.end());
    return v[v.size() / 2];
}
// `most`: spacings, of the mean error of a round. Returns the mean errors; the farthest push of all rounds in `pushed`.
inline std::vector<double> rounds(Device& device, const std::string& method, Relation relation, uint32_t count, double most,
                                  double& pushed) {
    std::vector<double> errors;
    eachRound(count, [&](Dice& dice) {
        const Found found = relation(device, method, dice);
        EXPECT_LE(found.error.mean, most) << "spacings";
        errors.push_back(found.error.mean);
        pushed = std::max(pushed, found.pushed);
    });
    return errors;
}

}  // namespace rivulet::relations
