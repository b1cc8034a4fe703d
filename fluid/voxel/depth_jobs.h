// The triangles of meshes as rows to draw into depth images.
#pragma once

#include <span>
#include <vector>

#include "engine/core/mesh_view.h"
#include "fluid/voxel/voxel_grid.h"
#include "shaders/voxel/depth.h"

namespace rivulet {

static_assert(sizeof(DepthJob) == 104 && sizeof(DepthBox) == 32 && sizeof(DepthParams) == 32, "as the GPUs lay them out");

// Of all triangles along all three axes, those that a line through voxels' centres may meet; few enough pixels each for a thread.
// The same list for any number of threads.
std::vector<DepthJob> depthJobs(std::span<const MeshView> meshes, const VoxelGrid& grid);

// Draws them on the host, as shaders/voxel/voxelize_depth.kernel does.
void drawDepthJobs(std::span<const DepthJob> jobs, const DepthParams& params, std::span<const DepthBox> boxes, std::span<uint32_t> images);

}  // namespace rivulet
