// Triangle-box overlap by separating axes (Akenine-Möller 2001), solved for whole rows of voxels (in the manner of Schwarz and Seidel
// 2010).
#include "fluid/voxel/voxelize_surface.h"

#include <oneapi/tbb/parallel_for.h>

#include <array>
#include <atomic>

namespace rivulet {
namespace {

constexpr double kTouch = 1e-9;  // voxels

// One separating axis: a voxel whose centre is q (measured from the triangle's corner a) overlaps as far as this axis can tell iff
// low <= axis . q <= high.
struct Slab {
    dvec3 axis{0.0};
    double low = 0, high = 0, perX = 0;  // perX: 1 / axis.x, 0 if the axis has no x
};

Slab slabOf(const GridTriangle& t, const dvec3& axis, double slack) {
    const double b = glm::dot(axis, t.ab);
    const double c = glm::dot(axis, t.ac);
    const double half = 0.5 * (std::abs(axis.x) + std::abs(axis.y) + std::abs(axis.z));
    const double reach = half * (1.0 + 2.0 * kTouch) + slack;
    return {axis, std::min(0.0, std::min(b, c)) - reach, std::max(0.0, std::max(b, c)) + reach, axis.x != 0.0 ? 1.0 / axis.x : 0.0};
}

// Sets bits [first, last] of the row-major order. Other threads may be setting their neighbours.
void setRun(VoxelGrid& grid, size_t first, size_t last) {
    for (size_t byte = first >> 3U; byte <= last >> 3U; ++byte) {
        unsigned mask = 0xFFU;
        if (byte == first >> 3U) mask &= 0xFFU << (first & 7U);
        if (byte == last >> 3U) mask &= 0xFFU >> (7U - (last & 7U));
        std::atomic_ref<uint8_t> bits(grid.bits[byte]);
        if ((bits.load(std::memory_order_relaxed) & mask) != mask) bits.fetch_or(static_cast<uint8_t>(mask), std::memory_order_relaxed);
    }
}

void voxelizeTriangle(const GridTriangle& t, VoxelGrid& grid) {
    // The box's own axes: bounds of the candidates.
    const dvec3 low = t.low(), high = t.high();
    ivec3 first(0), last(0);
    for (int k = 0; k < 3; ++k) {
        first[k] = static_cast<int>(std::max(0.0, std::floor(low[k] - kTouch)));
        last[k] = static_cast<int>(std::min(grid.size[k] - 1.0, std::floor(high[k] + kTouch)));
        if (first[k] > last[k]) return;
    }
    // The triangle's plane. Of a triangle without area the normal is rounding's: it may separate nothing by less than that.
    const double reach = 1.0 + glm::length(t.ab) + glm::length(t.ac);
    std::array<Slab, 7> sloped;
    sloped[0] = slabOf(t, glm::cross(t.ab, t.ac), 1e-15 * glm::length(t.ab) * glm::length(t.ac) * reach);
    // Edges across the box's edges; those across x say the same for a whole row.
    std::array<Slab, 3> level;
    const std::array<dvec3, 3> edges{t.ab, t.ac, t.ac - t.ab};
    for (size_t k = 0; k < 3; ++k) {
        const dvec3& e = edges[k];
        level[k] = slabOf(t, dvec3(0.0, e.z, -e.y), 0.0);
        sloped[1 + 2 * k] = slabOf(t, dvec3(-e.z, 0.0, e.x), 0.0);
        sloped[2 + 2 * k] = slabOf(t, dvec3(e.y, -e.x, 0.0), 0.0);
    }
    for (int z = first.z; z <= last.z; ++z) {
        const double qz = z + 0.5 - t.a.z;
        for (int y = first.y; y <= last.y; ++y) {
            const double qy = y + 0.5 - t.a.y;
            bool apart = false;
            for (const Slab& s : level) {
                const double at = s.axis.y * qy + s.axis.z * qz;
                apart = apart || at < s.low || at > s.high;
            }
            double from = first.x + 0.5 - t.a.x, to = last.x + 0.5 - t.a.x;
            for (const Slab& s : sloped) {
                const double at = s.axis.y * qy + s.axis.z * qz;
                if (s.perX == 0.0) {
                    apart = apart || at < s.low || at > s.high;
                } else {
                    const double one = (s.low - at) * s.perX, other = (s.high - at) * s.perX;
                    from = std::max(from, std::min(one, other));
                    to = std::min(to, std::max(one, other));
                }
            }
            if (apart || from > to) continue;
            const int x0 = std::max(first.x, static_cast<int>(std::ceil(from + t.a.x - 0.5)));
            const int x1 = std::min(last.x, static_cast<int>(std::floor(to + t.a.x - 0.5)));
            if (x0 <= x1) setRun(grid, grid.index({x0, y, z}), grid.index({x1, y, z}));
        }
    }
}

}  // namespace

void voxelizeSurface(const GridTriangles& triangles, VoxelGrid& grid) {
    tbb::parallel_for(tbb::blocked_range<size_t>(0, triangles.size(), 256), [&](const tbb::blocked_range<size_t>& range) {
        for (size_t k = range.begin(); k != range.end(); ++k) voxelizeTriangle(triangles[k], grid);
    });
}

}  // namespace rivulet
