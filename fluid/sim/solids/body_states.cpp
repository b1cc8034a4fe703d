#include "fluid/sim/solids/body_states.h"

#include <algorithm>

namespace rivulet {

void BodyStates::keep(double time, std::vector<BodyState> states) {
    if (kept_.size() == kKept) kept_.pop_front();
    kept_.emplace_back(time, std::move(states));
}

std::optional<std::vector<BodyState>> BodyStates::at(double time) const {
    const auto found = std::ranges::find_if(kept_.rbegin(), kept_.rend(), [time](const auto& one) { return one.first == time; });
    if (found == kept_.rend()) return std::nullopt;
    return found->second;
}

}  // namespace rivulet
