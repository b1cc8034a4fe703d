#include "fluid/sim/block.h"

#include <algorithm>
#include <cmath>

namespace rivulet {

namespace {
// A hair more than the edge allows: 0.5 m at 0.02 m is 25, not 24, whatever the rounding.
double along(float lo, float hi, float spacing) { return std::max(std::floor((double{hi} - double{lo}) / spacing + 1e-3), 0.0); }
}  // namespace

double blockCount(const BlockParams& b, float spacing) {
    return along(b.min.x, b.max.x, spacing) * along(b.min.y, b.max.y, spacing) * along(b.min.z, b.max.z, spacing);
}

void fillBlock(const BlockParams& b, float spacing, std::vector<NewParticle>& to) {
    const int nx = static_cast<int>(along(b.min.x, b.max.x, spacing)), ny = static_cast<int>(along(b.min.y, b.max.y, spacing)),
              nz = static_cast<int>(along(b.min.z, b.max.z, spacing));
    const vec3 lattice = vec3(static_cast<float>(nx), static_cast<float>(ny), static_cast<float>(nz)) * spacing;
    const vec3 first = b.min + 0.5F * (b.max - b.min - lattice) + vec3(0.5F * spacing);
    to.reserve(to.size() + static_cast<size_t>(blockCount(b, spacing)));
    for (int z = 0; z < nz; ++z)
        for (int y = 0; y < ny; ++y)
            for (int x = 0; x < nx; ++x)
                to.push_back({first + vec3(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)) * spacing, b.velocity});
}

}  // namespace rivulet
