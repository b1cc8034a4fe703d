// What a mesh is to those who may not see a scene (voxelisers, flow): spans over somebody else's memory.
#pragma once

#include <cstdint>
#include <span>

#include "engine/core/math.h"

namespace rivulet {

struct MeshView {
    std::span<const vec3> positions;    // m
    std::span<const uint32_t> indices;  // 3 a triangle, each < positions.size()
    std::span<const vec3> normals;      // empty, or one a position, unit length
    std::span<const vec2> uvs;          // empty, or one a position
    size_t triangleCount() const { return indices.size() / 3; }
};

}  // namespace rivulet
