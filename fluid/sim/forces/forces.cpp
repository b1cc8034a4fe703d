#include <algorithm>
#include <array>
#include <string_view>

#include "fluid/sim/forces/force.h"
#include "fluid/sim/methods/smoothing.h"

namespace rivulet {

Table<ForceRow> forces() {
    static const auto rows = [] {
        auto all = std::to_array<ForceRow>({RIVULET_FORCE_ROWS});
        std::sort(all.begin(), all.end(), [](const ForceRow& a, const ForceRow& b) {
            return a.order != b.order ? a.order < b.order : std::string_view(a.name) < b.name;
        });
        return all;
    }();
    return {rows};
}

StepParams forceParams(const StepContext& context, const vec4& force) {
    FluidParams wendland = context.fluid;
    wendland.kernel = "wendland";
    StepParams s = context.params;
    fillSmoothing(wendland, s);
    s.force = force;
    return s;
}

}  // namespace rivulet
