// Mesh: triangles with their own memory. Voxelisers and flow receive its view().
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/core/math.h"
#include "engine/core/mesh_view.h"

namespace rivulet {

struct Mesh {
    std::string name;
    std::vector<vec3> positions;    // m, or the unit of the file until a transform is applied
    std::vector<vec3> normals;      // empty, or one per position, unit length
    std::vector<vec2> uvs;          // empty, or one per position
    std::vector<uint32_t> indices;  // 3 per triangle, each < positions.size()

    MeshView view() const { return {positions, indices, normals, uvs}; }
    Bounds bounds() const;
};

// Sets each vertex normal to the mean of its triangles' normals, weighted by their areas.
void recomputeNormals(Mesh& mesh);

// A copy with positions moved by `toWorld` and normals by its inverse transpose; a mirroring matrix also reverses the orientation of the
// triangles.
Mesh transformed(const Mesh& mesh, const mat4& toWorld);

}  // namespace rivulet
