// Checks of meshes before they are voxelised, and their error messages.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "engine/core/mesh_view.h"
#include "engine/core/result.h"

namespace rivulet {

// Bounds of the triangles and their longest side (m). Vertices that no triangle uses do not count.
struct MeshExtent {
    Bounds bounds;
    double longest = 0;
};
MeshExtent extentOf(std::span<const MeshView> meshes);

// Returns an error unless indices come in threes and are in range, vertices are finite, and triangles number 1 to 2^32 - 1.
std::optional<Error> checkMeshes(std::span<const MeshView> meshes);

// Returns an error if the mesh has no extent, or if 32-bit floats cannot distinguish voxels that far from the origin. `voxel`: m.
std::optional<Error> checkVoxel(const MeshExtent& extent, float voxel);

}  // namespace rivulet
