// Solid voxels: voxels whose centre a mesh encloses, by signed crossings along columns of voxels; open meshes by their generalized winding
// number (Jacobson et al. 2013).
#pragma once

#include <functional>

#include "engine/compute/device.h"
#include "engine/core/result.h"
#include "fluid/voxel/mesh_defects.h"
#include "fluid/voxel/voxel_grid.h"

namespace rivulet {

// Sets the bit of each voxel of `inside` whose centre has a generalized winding number above 1/2 or below -1/2, and clears the others;
// `inside` gives size, origin and voxel. Surface voxels are not added. A centre on the surface (within rounding, about 1e-10 voxels) may
// count either way; all others are exact for any shape of triangle. The same bits on every Device and for any number of threads.
// A mesh of more than 1,024 open pieces (loops of boundary edges, long ones in parts) is the exception: there the winding number is
// computed to an accuracy of about 0.02 (see WindingTree), and voxels that are as near to 1/2 may count either way.
// `progress` is called repeatedly with 0..1 from the calling thread if there are hundreds of pieces or more; false cancels.
// Error (failed): cancelled, a device without 64-bit floats, or without enough memory.
Status voxelizeSolid(Device& device, const CleanMesh& mesh, VoxelGrid& inside, const std::function<bool(double)>& progress = {});

// The same on the host: false if cancelled. Throws std::bad_alloc.
bool voxelizeSolid(const CleanMesh& mesh, VoxelGrid& inside, const std::function<bool(double)>& progress = {});

}  // namespace rivulet
