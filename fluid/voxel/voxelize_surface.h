// Surface voxels: every voxel that a triangle overlaps, by the separating-axis test of Akenine-Möller 2001, a row of voxels at a time.
#pragma once

#include "fluid/voxel/triangles.h"

namespace rivulet {

// Sets the bits of all voxels of `grid` that a triangle overlaps; touching counts (within 1e-9 voxels, far below what floats can tell).
// A triangle without area counts as the segment or the point it is. The same bits for any number of threads.
void voxelizeSurface(const GridTriangles& triangles, VoxelGrid& grid);

}  // namespace rivulet
