// Solid voxels: those whose centre a mesh encloses, by signed crossings along columns of voxels; open meshes by their generalized winding
// number (Jacobson et al. 2013).
#pragma once

#include <functional>

#include "engine/compute/device.h"
#include "engine/core/result.h"
#include "fluid/voxel/mesh_defects.h"
#include "fluid/voxel/voxel_grid.h"

namespace rivulet {

// Sets the bit of each voxel of `inside` whose centre has a generalized winding number beyond 1/2 either way, and clears the others;
// `inside` brings size, origin and voxel. The surface's own voxels are not added. A centre on the surface (within rounding, about 1e-10
// voxels) may go either way; no others may, whatever the triangles' shape. The same bits on every Device and for any number of threads.
// A mesh of more than 1,024 open pieces (loops of boundary edges, long ones in parts) is the exception: there the winding number is
// reckoned to an accuracy of about 0.02 (see WindingTree), and voxels that are as near to 1/2 may go either way.
// `progress` is called now and then with 0..1 from the calling thread where there are hundreds of pieces and more; false cancels.
// Error (failed): cancelled, a device without 64-bit floats, or out of its memory.
Status voxelizeSolid(Device& device, const CleanMesh& mesh, VoxelGrid& inside, const std::function<bool(double)>& progress = {});

// The same on the host: false if cancelled. Throws std::bad_alloc.
bool voxelizeSolid(const CleanMesh& mesh, VoxelGrid& inside, const std::function<bool(double)>& progress = {});

}  // namespace rivulet
