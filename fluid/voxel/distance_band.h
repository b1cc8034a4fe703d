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
DistanceBand distanceBand(const GridTriangles& triangles, const ivec3& size, double band);

// A direction in 32 bits, on an octahedron (Meyer et al. 2010): x and y of its unfolded square as 16 bits each, x low. Exact to 1e-4.
// Any length but 0.
uint32_t packNormal(const dvec3& direction);

}  // namespace rivulet
