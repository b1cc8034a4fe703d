// Surface voxels: every voxel that a triangle overlaps, by the separating-axis test of Akenine-Möller 2001, a row of voxels at a time.
#pragma once

#include "engine/compute/device.h"
#include "engine/core/result.h"
#include "fluid/voxel/triangles.h"

namespace rivulet {

// Sets the bits of all voxels of `grid` that a triangle overlaps, and leaves the others; touching counts (within 1e-9 voxels, far below
// the resolution of floats). A triangle without area counts as the segment or the point that it is. The same bits on every Device and for
// any number of threads. Error (failed): a device without 64-bit floats, or without enough memory; `grid` is then unchanged.
Status voxelizeSurface(Device& device, const GridTriangles& triangles, VoxelGrid& grid);

// The same on the host.
void voxelizeSurface(const GridTriangles& triangles, VoxelGrid& grid);

}  // namespace rivulet
