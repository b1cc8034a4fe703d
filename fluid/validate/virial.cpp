#include "fluid/validate/virial.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <unordered_map>

#include "engine/core/assert.h"
#include "fluid/sim/methods/smoothing.h"

namespace rivulet {

std::vector<double> virialPressures(std::span<const vec4> positions, std::span<const float> pressures, const FluidParams& p) {
    ASSERT(positions.size() == pressures.size(), "a pressure for each particle");
    const double spacing = p.spacing, h = spacing * double{p.supportSpacings};
    // V r |W'(r)| = factor r^2 (h - r)^3
    const double factor = std::pow(spacing, 3) * 210 / (std::numbers::pi * std::pow(h, 8)) / wendlandLatticeSum(p.supportSpacings);
    const double pull = pullScale(p.kernel, p.supportSpacings);
    const auto cellOf = [h](const vec4& x) { return glm::i64vec3(glm::floor(glm::dvec3(x) / h)); };
    const auto keyOf = [](const glm::i64vec3& c) { return static_cast<uint64_t>(c.x * 73856093 ^ c.y * 19349663 ^ c.z * 83492791); };
    std::unordered_map<uint64_t, std::vector<size_t>> cells;  // keys may collide; distances decide
    for (size_t i = 0; i < positions.size(); ++i)
        if (!(positions[i].w < 0)) cells[keyOf(cellOf(positions[i]))].push_back(i);
    std::vector<double> virial(positions.size());
    for (size_t i = 0; i < positions.size(); ++i) {
        if (positions[i].w < 0) continue;
        std::vector<uint64_t> keys;
        for (int k = 0; k < 27; ++k) {
            const uint64_t key = keyOf(cellOf(positions[i]) + glm::i64vec3(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1));
            if (std::find(keys.begin(), keys.end(), key) == keys.end()) keys.push_back(key);
        }
        double sum = 0;
        for (const uint64_t key : keys) {
            const auto found = cells.find(key);
            if (found == cells.end()) continue;
            for (const size_t j : found->second) {
                const glm::dvec3 d = glm::dvec3(positions[i]) - glm::dvec3(positions[j]);
                const double r2 = glm::dot(d, d);
                if (!(r2 < h * h)) continue;
                const double r = std::sqrt(r2), a = pressures[i], b = pressures[j];
                // Negative pressures have the weights of shaders/fluid/methods/pull.h.
                const double push = std::max(a, 0.0) + std::max(b, 0.0),
                             pulled = (std::min(a, 0.0) + std::min(b, 0.0)) * pull * (r / spacing - kPullFrom);
                sum += 0.5 * (push + pulled) * r2 * std::pow(h - r, 3);
            }
        }
        virial[i] = factor * sum / 3;
    }
    return virial;
}

}  // namespace rivulet
