#include "engine/render/gpu_mesh.h"

#include <rivulet_glad/gl.h>

#include <algorithm>

namespace rivulet {

namespace {

// Estimates curvature: on a sphere of radius r, the end of an edge e is e^2 / 2r below the tangent plane.
std::vector<float> meanCurvatures(const Mesh& mesh) {
    std::vector<float> fall(mesh.positions.size(), 0.0F), squares(fall);
    if (mesh.normals.size() != mesh.positions.size()) return fall;
    for (size_t t = 0; t + 2 < mesh.indices.size(); t += 3)
        for (size_t k = 0; k < 3; ++k) {
            const uint32_t v = mesh.indices[t + k];
            for (const uint32_t w : {mesh.indices[t + (k + 1) % 3], mesh.indices[t + (k + 2) % 3]}) {
                const vec3 edge = mesh.positions[w] - mesh.positions[v];
                fall[v] -= 2.0F * glm::dot(mesh.normals[v], edge);
                squares[v] += glm::dot(edge, edge);
            }
        }
    for (size_t v = 0; v < fall.size(); ++v) fall[v] = squares[v] > 0 ? fall[v] / squares[v] : 0.0F;
    return fall;
}

// For each vertex: the longest edge of its triangles, in uv.
std::vector<float> reaches(const Mesh& mesh) {
    std::vector<float> reach(mesh.positions.size(), 0.0F);
    if (mesh.uvs.size() != mesh.positions.size()) return reach;
    for (size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
        const uint32_t* v = &mesh.indices[t];
        const float longest = std::max({glm::distance(mesh.uvs[v[0]], mesh.uvs[v[1]]), glm::distance(mesh.uvs[v[1]], mesh.uvs[v[2]]),
                                        glm::distance(mesh.uvs[v[2]], mesh.uvs[v[0]])});
        for (size_t k = 0; k < 3; ++k) reach[v[k]] = std::max(reach[v[k]], longest);
    }
    return reach;
}

}  // namespace

Result<GpuMesh> GpuMesh::create(const Mesh& mesh) {
    struct Vertex {
        vec3 position;
        vec4 normal;
        vec3 uv;
    };
    const std::vector<float> curvature = meanCurvatures(mesh);
    const std::vector<float> reach = reaches(mesh);
    std::vector<Vertex> vertices(mesh.positions.size(), Vertex{});
    for (size_t i = 0; i < vertices.size(); ++i)
        vertices[i] = {mesh.positions[i], vec4(i < mesh.normals.size() ? mesh.normals[i] : vec3(0.0F), curvature[i]),
                       i < mesh.uvs.size() ? vec3(mesh.uvs[i], reach[i]) : vec3(0.0F)};
    GpuMesh out;
    Result<gpu::Buffer> vertexBuffer = gpu::Buffer::from(vertices);
    if (!vertexBuffer) return vertexBuffer.error();
    Result<gpu::Buffer> indexBuffer = gpu::Buffer::from(mesh.indices);
    if (!indexBuffer) return indexBuffer.error();
    out.vertices_ = std::move(*vertexBuffer);
    out.indices_ = std::move(*indexBuffer);
    out.array_ = gpu::VertexArray::create();
    out.array_.attribute(0, out.vertices_.name(), 3, GL_FLOAT, sizeof(Vertex), offsetof(Vertex, position));
    out.array_.attribute(1, out.vertices_.name(), 4, GL_FLOAT, sizeof(Vertex), offsetof(Vertex, normal));
    out.array_.attribute(2, out.vertices_.name(), 3, GL_FLOAT, sizeof(Vertex), offsetof(Vertex, uv));
    out.array_.elements(out.indices_.name());
    out.bounds_ = mesh.bounds();
    out.count_ = static_cast<int>(mesh.indices.size());
    return out;
}

Status GpuMesh::follow(const Deformer& deformer) {
    bounds_ = deformer.bounds();
    if (followed_ == deformer.version()) return ok();
    Device& device = deformer.device();
    GLuint names[2] = {static_cast<GLuint>(deformer.positions().handle()), static_cast<GLuint>(deformer.normals().handle())};
    if (device.backend() != Backend::gl) {
        copy_.resize(deformer.vertices());
        const std::span<std::byte> bytes = std::as_writable_bytes(std::span(copy_));
        const std::pair<const rivulet::Buffer*, gpu::Buffer*> all[] = {{&deformer.positions(), &positions_},
                                                                       {&deformer.normals(), &normals_}};
        for (const auto& [from, to] : all) {
            if (to->bytes() != bytes.size()) {
                Result<gpu::Buffer> made = gpu::Buffer::create(bytes.size());
                if (!made) return made.error();
                *to = std::move(*made);
            }
            device.read(*from, bytes);
            to->write(bytes);
        }
        names[0] = positions_.name();
        names[1] = normals_.name();
    }
    array_.attribute(0, names[0], 3, GL_FLOAT, sizeof(vec4));
    array_.attribute(1, names[1], 4, GL_FLOAT, sizeof(vec4));
    followed_ = deformer.version();
    return ok();
}

void GpuMesh::draw() const {
    array_.bind();
    glDrawElements(GL_TRIANGLES, count_, GL_UNSIGNED_INT, nullptr);
}

}  // namespace rivulet
