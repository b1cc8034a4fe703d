#include "engine/scene/mesh.h"

#include <glm/matrix.hpp>

#include "engine/scene/transform.h"

namespace rivulet {

Bounds Mesh::bounds() const {
    Bounds b;
    for (const vec3& p : positions) b.add(p);
    return b;
}

void recomputeNormals(Mesh& mesh) {
    mesh.normals.assign(mesh.positions.size(), vec3(0.0F));
    for (size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
        const uint32_t a = mesh.indices[t], b = mesh.indices[t + 1], c = mesh.indices[t + 2];
        const vec3 n = glm::cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]);
        for (uint32_t v : {a, b, c}) mesh.normals[v] += n;
    }
    for (vec3& n : mesh.normals) {
        const float size = glm::length(n);
        n = size > 0 ? n / size : vec3(0, 1, 0);
    }
}

Mesh transformed(const Mesh& mesh, const mat4& toWorld) {
    Mesh out = mesh;
    for (vec3& p : out.positions) p = transformPoint(toWorld, p);
    mat3 linear(toWorld);
    float determinant = glm::determinant(linear);
    if (determinant != 0.0F) {
        mat3 normalMatrix = glm::transpose(glm::inverse(linear));
        for (vec3& n : out.normals) {
            vec3 turned = normalMatrix * n;
            float length = glm::length(turned);
            if (length > 0.0F) n = turned / length;
        }
    }
    if (determinant < 0.0F)
        for (size_t t = 0; t + 2 < out.indices.size(); t += 3) std::swap(out.indices[t + 1], out.indices[t + 2]);
    return out;
}

}  // namespace rivulet
