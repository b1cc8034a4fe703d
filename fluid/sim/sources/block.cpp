#include "fluid/sim/sources/block.h"

#include <algorithm>
#include <cmath>

namespace rivulet {

namespace {
// A hair more than the edge allows: 0.5 m at 0.02 m is 25, not 24, whatever the rounding.
double along(float lo, float hi, float spacing) { return std::max(std::floor((double{hi} - double{lo}) / spacing + 1e-3), 0.0); }

// -1..1, evenly, of any two numbers (the finalizer of MurmurHash3, Appleby 2011).
float jittered(uint32_t place, uint32_t axis) {
    uint64_t k = (uint64_t{place} << 2U | axis) + 1;
    for (const uint64_t factor : {0xff51afd7ed558ccdULL, 0xc4ceb9fe1a85ec53ULL}) {
        k ^= k >> 33U;
        k *= factor;
    }
    k ^= k >> 33U;
    return static_cast<float>(k >> 40U) / 8388608.0F - 1.0F;
}
}  // namespace

double blockCount(const BlockParams& b, float spacing) {
    return along(b.min.x, b.max.x, spacing) * along(b.min.y, b.max.y, spacing) * along(b.min.z, b.max.z, spacing);
}

void fillBlock(const BlockParams& b, float spacing, std::vector<NewParticle>& to) {
    const int nx = static_cast<int>(along(b.min.x, b.max.x, spacing)), ny = static_cast<int>(along(b.min.y, b.max.y, spacing)),
              nz = static_cast<int>(along(b.min.z, b.max.z, spacing));
    const vec3 lattice = vec3(static_cast<float>(nx), static_cast<float>(ny), static_cast<float>(nz)) * spacing;
    const vec3 first = b.min + 0.5F * (b.max - b.min - lattice) + vec3(0.5F * spacing);
    const vec3 last = first + lattice - vec3(spacing);
    to.reserve(to.size() + static_cast<size_t>(blockCount(b, spacing)));
    const bool ball = b.shape == "ball";
    const vec3 middle = 0.5F * (b.min + b.max), half = 0.5F * (b.max - b.min);
    uint32_t place = 0;
    for (int z = 0; z < nz; ++z)
        for (int y = 0; y < ny; ++y)
            for (int x = 0; x < nx; ++x, ++place) {
                vec3 at = first + vec3(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)) * spacing;
                if (ball && glm::length((at - middle) / half) > 1) continue;
                if (b.jitter > 0)
                    at =
                        glm::clamp(at + b.jitter * spacing * vec3(jittered(place, 0), jittered(place, 1), jittered(place, 2)), first, last);
                to.push_back({at, b.velocity});
            }
}

}  // namespace rivulet
