#include "fluid/sim/world/state_check.h"

#include <fmt/format.h>

namespace rivulet {

Error outOfRange(std::string_view section, size_t item, double value, double least, double most) {
    return badInput(fmt::format("section {} of the saved state has {} as number {}, which must be from {} to {}: save it again", section,
                                value, item, least, most));
}

namespace {

template <class T>
Status check(std::string_view section, std::span<const T> values, T least, T most) {
    for (size_t k = 0; k < values.size(); ++k)
        if (!(values[k] >= least && values[k] <= most)) return outOfRange(section, k, double{values[k]}, double{least}, double{most});
    return ok();
}

}  // namespace

Status checkRange(std::string_view section, std::span<const float> values, float least, float most) {
    return check(section, values, least, most);
}

Status checkRange(std::string_view section, std::span<const double> values, double least, double most) {
    return check(section, values, least, most);
}

Status checkRange(std::string_view section, std::span<const vec4> values, float most, float leastW, float mostW) {
    for (size_t k = 0; k < values.size(); ++k) {
        const vec4& v = values[k];
        for (int axis = 0; axis < 3; ++axis)
            if (!(std::abs(v[axis]) <= most))
                return outOfRange(section, 4 * k + static_cast<size_t>(axis), double{v[axis]}, double{-most}, double{most});
        if (!(v.w >= leastW && v.w <= mostW)) return outOfRange(section, 4 * k + 3, double{v.w}, double{leastW}, double{mostW});
    }
    return ok();
}

}  // namespace rivulet
