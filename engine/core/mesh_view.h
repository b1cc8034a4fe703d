// A view of a mesh's arrays, for code that does not include engine/scene (voxelisers, flow). The caller owns the memory.
#pragma once

#include <cstdint>
#include <span>

#include "engine/core/math.h"

namespace rivulet {

struct MeshView {
    std::span<const vec3> positions;    // m
    std::span<const uint32_t> indices;  // 3 per triangle, each < positions.size()
    std::span<const vec3> normals;      // empty, or one per position, unit length
    std::span<const vec2> uvs;          // empty, or one per position
    size_t triangleCount() const { return indices.size() / 3; }
};

}  // namespace rivulet
