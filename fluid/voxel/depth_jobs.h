// The triangles of meshes as rows to draw into depth images.
#pragma once

#include <span>
#include <vector>

#include "engine/core/mesh_view.h"
#include "fluid/voxel/voxel_grid.h"
#include "shaders/voxel/depth.h"

namespace rivulet {

static_assert(sizeof(DepthJob) == 104 && sizeof(DepthBox) == 32 && sizeof(DepthParams) == 32, "the layout of the GPUs");

// The triangles, along all three axes, that a line through voxel centres may meet. Each job has few enough pixels for one thread.
// The list does not depend on the number of threads.
std::vector<DepthJob> depthJobs(std::span<const MeshView> meshes, const VoxelGrid& grid);

// Draws the jobs on the host, as shaders/voxel/voxelize_depth.kernel does.
void drawDepthJobs(std::span<const DepthJob> jobs, const DepthParams& params, std::span<const DepthBox> boxes, std::span<uint32_t> images);

}  // namespace rivulet
