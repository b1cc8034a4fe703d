// The static field: every static mesh collider of a scene baked into surface bits and a narrow band of exact triangle distance.
#pragma once

#include <vector>

#include "engine/core/mesh_view.h"
#include "engine/core/result.h"
#include "fluid/voxel/voxel_grid.h"

namespace rivulet {

// Distance is sampled at grid points p = origin + voxel * (x, y, z), 0 <= x <= size.x and so on: (size + 1) points an axis, x fastest.
struct VoxelField {
    VoxelGrid surface;             // voxels that a triangle passes through
    std::vector<float> distance;   // m, >= 0, to the nearest triangle, exact within `band`, `band` beyond it
    float band = 0;                // m
    bool empty() const { return surface.count() == 0; }
};

struct VoxelFieldOptions {
    int resolution = 128;   // voxels along the longest side of the meshes' bounds
    float band = 0;         // m, at least this wide
    float padding = 0;      // m, around the bounds: at least the band, so that whoever comes near is inside the grid
};

// `meshes` in world space (m). Error: no triangle, NaN or infinite vertices (with how many), out of memory (with how much it needs).
Result<VoxelField> bakeVoxelField(std::span<const MeshView> meshes, const VoxelFieldOptions& options);

}  // namespace rivulet
