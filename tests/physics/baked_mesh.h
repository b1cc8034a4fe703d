// The voxel field of a test mesh, with a band wide enough for collisions.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>

#include "fluid/voxel/voxel_field.h"
#include "tests/unit/voxel_test_meshes.h"

namespace rivulet::test {

// `voxel`, `spacing`: m.
inline VoxelField baked(const Mesh& mesh, float voxel, float spacing) {
    const MeshView view = mesh.view();
    Bounds bounds;
    for (const vec3& p : mesh.positions) bounds.add(p);
    const vec3 size = bounds.size();
    Result<VoxelField> field = bakeVoxelField(
        std::span(&view, 1),
        {.resolution = static_cast<int>(std::max(size.x, std::max(size.y, size.z)) / voxel), .band = 2 * spacing, .padding = 2 * spacing});
    EXPECT_TRUE(field) << (field ? "" : field.error().message);
    return std::move(*field);
}

}  // namespace rivulet::test
