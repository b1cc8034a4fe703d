// Mesh: triangles that own their memory. view() is what voxelisers and flow see of it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/core/math.h"
#include "engine/core/mesh_view.h"

namespace rivulet {

struct Mesh {
    std::string name;
    std::vector<vec3> positions;    // m, or the file's unit until a transform was applied
    std::vector<vec3> normals;      // empty, or one a position, unit length
    std::vector<vec2> uvs;          // empty, or one a position
    std::vector<uint32_t> indices;  // 3 a triangle, each < positions.size()

    MeshView view() const { return {positions, indices, normals, uvs}; }
    Bounds bounds() const;
};

// Each corner's from its triangles, weighted by their areas.
void recomputeNormals(Mesh& mesh);

// A copy with positions moved by `toWorld` and normals by its inverse transpose; a mirroring matrix also turns the triangles around.
Mesh transformed(const Mesh& mesh, const mat4& toWorld);

}  // namespace rivulet
