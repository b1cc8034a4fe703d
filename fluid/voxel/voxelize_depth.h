// Mode depth: the thesis's voxeliser [4.1]: depth images of work boxes tell which voxels lines of sight pass before they meet a
// triangle; boxes are divided until every voxel is known; lines join what is connected into materials.
#pragma once

#include <functional>
#include <span>

#include "engine/compute/device.h"
#include "engine/core/mesh_view.h"
#include "fluid/voxel/labels.h"

namespace rivulet {

struct DepthOptions {
    // false: the whole box, then slabs of thickness 1 along x, y, z where something is unknown.
    // true: the whole box, then slabs of thickness min(w, h, d) / 2, one less, and so on to 1, along x, y, z each.
    bool thesisOrder = false;
    std::function<bool(double)> progress;  // as VoxelizeOptions::progress
};

struct DepthVoxels {
    VoxelGrid surface;   // INSIDE_SURFACE: one of the three lines along the axes through the voxel's centre meets a triangle within it
    VoxelLabels labels;  // the regions between, connected through faces of voxels
    size_t boxes = 0;    // work boxes that were drawn
    size_t pixels = 0;   // of their depth images, two ways each
};

// `grid`: bits clear; every triangle lies within it, touching counts (layoutGrid makes such a grid). Indices and vertices as
// checkMeshes wants them. A line that meets an edge or a corner meets exactly one of the triangles around it, unless the mesh ends there.
// A voxel is known to be free when lines of sight along all three axes have passed it. (The thesis takes one line's word. Then a voxel
// that one line passes and another hits is free or surface as the order of boxes has it, and where it is free a closed mesh leaks: the
// closed bunny of 7k triangles does at 128^3.) Hence a closed mesh parts inside from outside at any resolution, the result does not depend
// on the order, and is the same on every Device. Error (failed): cancelled, the device has no 64-bit floats or no memory.
// Throws std::bad_alloc.
Result<DepthVoxels> voxelizeDepth(Device& device, std::span<const MeshView> meshes, const VoxelGrid& grid, const DepthOptions& options);

// Bytes that takes for a grid of this size, besides what the triangles do.
double depthBytes(const dvec3& size);

}  // namespace rivulet
