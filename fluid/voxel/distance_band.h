// The narrow band: exact distance from grid points to the nearest triangle, and the direction away from it.
#pragma once

#include <vector>

#include "fluid/voxel/triangles.h"

namespace rivulet {

struct DistanceBand {
    std::vector<float> distance;   // voxels, to the nearest triangle; `band` where that is further
    std::vector<uint32_t> normal;  // from there to the point, see packNormal; of no meaning beyond the band
};

// At the (size + 1) points an axis of a grid of `size` voxels, x fastest. Unsigned; computed in double. The same for any number of threads.
// `surfaces`: of each mesh, for packNormal; empty: all 0.
DistanceBand distanceBand(const GridTriangles& triangles, std::span<const uint8_t> surfaces, const ivec3& size, double band);

// A direction on an octahedron (Meyer et al. 2010), x and y of its unfolded square as 14 bits each, x low: 1 is 8191 above the middle. The
// nearest of the four codes around (Cigolle et al. 2014), within 1.73e-4 rad of the direction; axes are exact. Any length but 0. Above them
// 4 bits: `surface`, 0..15, whose wall it is. Unpacked by unpackNormal and wallSurface of shaders/fluid/contact.h.
uint32_t packNormal(const dvec3& direction, uint32_t surface);

}  // namespace rivulet
