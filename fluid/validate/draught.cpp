#include "fluid/validate/draught.h"

#include <algorithm>
#include <cmath>

namespace rivulet {

double Floater::shareUnder(double deep) const {
    const double d = std::clamp(deep / height, 0.0, 1.0);
    return ball ? d * d * (3 - 2 * d) : d;
}

double waterVolume(std::span<const vec4> positions, double spacing) {
    double sum = 0;
    for (const vec4& x : positions)
        if (!(x.w < 0)) sum += 1 / std::max(double{x.w}, 1.0);
    return sum * std::pow(spacing, 3);
}

double waterLevel(double water, double area, std::span<const Floater> floaters) {
    // The submerged volume grows more slowly than level * area, because bodies cover less than the floor: the iteration converges.
    double low = water / area, high = low;
    for (const Floater& f : floaters) high += f.volume / area;
    for (int k = 0; k < 60; ++k) {
        const double level = 0.5 * (low + high);
        double filled = water;
        for (const Floater& f : floaters) filled += f.volume * f.shareUnder(level - f.keel);
        (filled > level * area ? low : high) = level;
    }
    return 0.5 * (low + high);
}

}  // namespace rivulet
