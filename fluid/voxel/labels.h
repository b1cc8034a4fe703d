// Connected regions of what is not surface.
#pragma once

#include <cstdint>
#include <vector>

#include "fluid/voxel/voxel_grid.h"

namespace rivulet {

// One byte a voxel, in the grid's order: 1 where the voxel is not set and can be reached from the grid's border through faces of voxels
// that are not set (the thesis's rule, whatever the mesh's topology); 0 for the surface and for what it encloses.
std::vector<uint8_t> reachableFromBorder(const VoxelGrid& surface);

}  // namespace rivulet
