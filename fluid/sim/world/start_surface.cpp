#include "fluid/sim/world/start_surface.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace rivulet {

namespace {

// Particles by cells with edges of one spacing.
class Cells {
  public:
    Cells(std::span<const NewParticle> particles, const FluidParams& params) : particles_(particles), params_(params) {
        // Across a periodic axis a cell may be a little wider, so that cells match at both ends.
        const vec3 size = params.box.max - params.box.min;
        for (int axis = 0; axis < 3; ++axis) {
            const double cells = std::max(std::floor(double{size[axis]} / double{params.spacing} + 1.0e-3), 1.0);
            count_[axis] = params.box.periodic()[axis] ? static_cast<int>(cells) : 0;
            edge_[axis] = count_[axis] > 0 ? size[axis] / static_cast<float>(cells) : params.spacing;
        }
        cells_.reserve(particles.size());
        for (size_t i = 0; i < particles.size(); ++i) cells_.emplace_back(key(cellOf(particles[i].position)), static_cast<uint32_t>(i));
        std::sort(cells_.begin(), cells_.end());
    }

    // Whether a particle other than number `self` is within `distance` (m, at most a spacing) of `p`.
    bool near(const vec3& p, float distance, size_t self) const {
        const ivec3 c = cellOf(p);
        for (int z = -1; z <= 1; ++z)
            for (int y = -1; y <= 1; ++y)
                for (int x = -1; x <= 1; ++x) {
                    const uint64_t cell = key(c + ivec3(x, y, z));
                    for (auto at = std::lower_bound(cells_.begin(), cells_.end(), std::pair(cell, 0U));
                         at != cells_.end() && at->first == cell; ++at)
                        if (at->second != self && glm::length(apart(p, particles_[at->second].position)) < distance) return true;
                }
        return false;
    }

  private:
    ivec3 cellOf(const vec3& p) const { return ivec3(glm::floor((p - params_.box.min) / edge_)); }
    uint64_t key(ivec3 c) const {
        uint64_t k = 0;
        for (int axis = 0; axis < 3; ++axis) {
            if (count_[axis] > 0) c[axis] = ((c[axis] % count_[axis]) + count_[axis]) % count_[axis];
            k = (k << 21U) | static_cast<uint64_t>(static_cast<uint32_t>(c[axis] + (1 << 20)) & 0x1fffffU);
        }
        return k;
    }
    vec3 apart(const vec3& a, const vec3& b) const {
        vec3 d = a - b;
        const vec3 size = params_.box.max - params_.box.min;
        for (int axis = 0; axis < 3; ++axis)
            if (count_[axis] > 0) d[axis] -= size[axis] * std::round(d[axis] / size[axis]);
        return d;
    }

    std::span<const NewParticle> particles_;
    const FluidParams& params_;
    vec3 edge_{1.0F};
    ivec3 count_{0};                                    // 0: the axis is not periodic
    std::vector<std::pair<uint64_t, uint32_t>> cells_;  // cell and particle, sorted
};

}  // namespace

bool hasFreeSurface(std::span<const NewParticle> particles, const FluidParams& params, const std::function<bool(const vec3&)>& maySpawn) {
    const Cells cells(particles, params);
    constexpr float kRounded = 0.998F;  // as for particles that start beside a mesh
    const float rest = 0.5F * kRounded * params.spacing;
    for (size_t i = 0; i < particles.size(); ++i)
        for (int k = 0; k < 6; ++k) {
            const int axis = k / 2;
            vec3 p = particles[i].position;
            p[axis] += (k & 1) != 0 ? params.spacing : -params.spacing;
            const float low = p[axis] - params.box.min[axis], high = params.box.max[axis] - p[axis];
            if (params.box.periodic()[axis]) {
                if (low < 0) p[axis] += params.box.max[axis] - params.box.min[axis];
                if (high < 0) p[axis] -= params.box.max[axis] - params.box.min[axis];
            } else if (std::min(low, high) < rest) {
                continue;
            }
            if (!cells.near(p, kRounded * params.spacing, i) && maySpawn(p)) return true;
        }
    return false;
}

}  // namespace rivulet
