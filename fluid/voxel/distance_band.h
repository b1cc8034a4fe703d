// The narrow band: exact distance from grid points to the nearest triangle.
#pragma once

#include <vector>

#include "fluid/voxel/triangles.h"

namespace rivulet {

// In voxels, at the (size + 1) points an axis of a grid of `size` voxels, x fastest: the distance to the nearest triangle, `band`
// where that is further. Unsigned; computed in double. The same for any number of threads.
std::vector<float> distanceBand(const GridTriangles& triangles, const ivec3& size, double band);

}  // namespace rivulet
