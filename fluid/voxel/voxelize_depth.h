// Mode depth: the thesis's voxeliser [4.1]. Depth images of work boxes show which voxels lines of sight pass before they meet a
// triangle; boxes are divided until every voxel is known; lines join connected voxels into materials.
#pragma once

#include <functional>
#include <span>

#include "engine/compute/device.h"
#include "engine/core/mesh_view.h"
#include "fluid/voxel/labels.h"

namespace rivulet {

struct DepthOptions {
    // false: the whole box, then slabs of thickness 1 along x, y, z where a voxel is unknown.
    // true: the whole box, then slabs of thickness min(w, h, d) / 2, one less, and so on to 1, along x, y, z each.
    bool thesisOrder = false;
    std::function<bool(double)> progress;  // see VoxelizeOptions::progress
};

struct DepthVoxels {
    VoxelGrid surface;   // INSIDE_SURFACE: one of the three lines along the axes through the voxel's centre meets a triangle within it
    VoxelLabels labels;  // the regions between, connected through faces of voxels
    size_t boxes = 0;    // work boxes drawn
    size_t pixels = 0;   // of their depth images, two directions each
};

// `grid`: bits clear; every triangle lies within it, touching counts (layoutGrid makes such a grid). Indices and vertices must
// pass checkMeshes. A line that meets an edge or a corner meets exactly one of the triangles around it, unless the mesh ends there.
// A voxel is free when lines of sight along all three axes have passed it. (In the thesis one line is enough. Then a voxel that one line
// passes and another hits is free or surface depending on the order of boxes, and where it is free a closed mesh leaks: the closed bunny
// of 7k triangles does at 128^3.) So a closed mesh separates inside from outside at any resolution, and the result does not depend on the
// order of boxes or on the Device. Error (failed): cancelled, the device has no 64-bit floats or no memory.
// Throws std::bad_alloc.
Result<DepthVoxels> voxelizeDepth(Device& device, std::span<const MeshView> meshes, const VoxelGrid& grid, const DepthOptions& options);

// Bytes that voxelizeDepth takes for a grid of this size, without the triangles.
double depthBytes(const dvec3& size);

}  // namespace rivulet
