// What a mesh must be before it is made into voxels, and the sentences that say so.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "engine/core/mesh_view.h"
#include "engine/core/result.h"

namespace rivulet {

// Where the triangles are, and how long the longest side is (m). Vertices that no triangle uses do not count.
struct MeshExtent {
    Bounds bounds;
    double longest = 0;
};
MeshExtent extentOf(std::span<const MeshView> meshes);

// Indices in threes and in range, finite vertices, at least one triangle and fewer than 2^32.
std::optional<Error> checkMeshes(std::span<const MeshView> meshes);

// An extent, and voxels that 32-bit floats can tell apart that far from the origin. `voxel`: m.
std::optional<Error> checkVoxel(const MeshExtent& extent, float voxel);

}  // namespace rivulet
