// The narrow band: exact distance from grid points to the nearest triangle, and the direction away from it.
#pragma once

#include <vector>

#include "engine/compute/device_cpu.h"
#include "fluid/voxel/triangles.h"

namespace rivulet {

inline constexpr uint32_t kNoTriangle = std::numeric_limits<uint32_t>::max();

// The results, at the (size + 1) points per axis of a grid, x fastest.
struct BandPoints {
    std::span<float> distance;    // m, to the nearest triangle, at most `band`
    std::span<uint32_t> normal;   // from the nearest triangle to the point, see packNormal; undefined beyond the band
    std::span<uint32_t> nearest;  // number of that triangle in the list, kNoTriangle beyond the band; empty if not needed
};

// Works in bricks of kBrick^3 points, so that a part can be baked again. Unsigned; computed in double. Of equally near triangles the first
// in the list counts, so the result depends on the triangles within the band alone, not on the number of threads or on the part baked.
class DistanceBand {
  public:
    static constexpr int kBrick = 4;
    DistanceBand(const VoxelGrid& grid, float band /* m */, Isa isa = bestIsa());
    const ivec3& bricks() const { return bricks_; }  // along each axis; brick b holds the points [kBrick b, kBrick (b + 1))
    size_t brickIndex(const ivec3& b) const {
        return (static_cast<size_t>(b.z) * static_cast<size_t>(bricks_.y) + static_cast<size_t>(b.y)) * static_cast<size_t>(bricks_.x) +
               static_cast<size_t>(b.x);
    }
    // Sets the flags (by brickIndex) of all bricks with a point to which this triangle may be the nearest, and of all bricks with a voxel
    // that it touches (voxel v belongs to brick v / kBrick).
    void markReach(const GridTriangle& triangle, std::span<uint8_t> flags) const;
    // Bricks, first and last along each axis, that a triangle in this box (grid coordinates) may reach. May be empty.
    void reach(const dvec3& low, const dvec3& high, ivec3& first, ivec3& last) const;
    // Writes all points of the bricks whose flag is set; without flags, of the bricks that a triangle reaches. `surfaces`: one per mesh,
    // for packNormal; empty: 0. `numbers`: one per triangle of the list, increasing, for `nearest`; empty: the index in the list.
    // `reached`, if not empty: set to 1 for each baked brick that a triangle reaches, to 0 for the other baked bricks.
    void bake(const GridTriangles& triangles, std::span<const uint8_t> surfaces, std::span<const uint32_t> numbers,
              std::span<const uint8_t> flags, std::span<uint8_t> reached, const BandPoints& out) const;

  private:
    double furthest() const { return std::max(points_.x, std::max(points_.y, points_.z)); }
    ivec3 points_, bricks_;
    float voxel_, band_;
    Isa isa_;
};

// Encodes a direction of any length above 0 on an octahedron (Meyer et al. 2010): x and y of its unfolded square, 14 bits each, x low; 1 is
// 8191 above the middle. Of the four neighbouring codes the nearest is taken (Cigolle et al. 2014): within 1.73e-4 rad of the direction;
// axes are exact. The 4 bits above are `surface`, 0..15, the wall's set of friction and restitution. Unpacked by unpackNormal, here and for
// kernels in shaders/fluid/solids/contact_walls.h, and by wallSurface there.
uint32_t packNormal(const dvec3& direction, uint32_t surface);
vec3 unpackNormal(uint32_t code);  // of unit length

}  // namespace rivulet
