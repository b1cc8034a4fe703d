#include "engine/render/gpu_mesh.h"

namespace rivulet {

Result<GpuMesh> GpuMesh::create(const Mesh& mesh) {
    struct Vertex {
        vec3 position, normal;
    };
    std::vector<Vertex> vertices(mesh.positions.size(), Vertex{});
    for (size_t i = 0; i < vertices.size(); ++i) vertices[i] = {mesh.positions[i], i < mesh.normals.size() ? mesh.normals[i] : vec3(0.0F)};
    GpuMesh out;
    Result<gpu::Buffer> vertexBuffer = gpu::Buffer::from(vertices);
    if (!vertexBuffer) return vertexBuffer.error();
    Result<gpu::Buffer> indexBuffer = gpu::Buffer::from(mesh.indices);
    if (!indexBuffer) return indexBuffer.error();
    out.vertices_ = std::move(*vertexBuffer);
    out.indices_ = std::move(*indexBuffer);
    out.array_ = gpu::VertexArray::create();
    out.array_.attribute(0, out.vertices_.name(), 3, GL_FLOAT, sizeof(Vertex), offsetof(Vertex, position));
    out.array_.attribute(1, out.vertices_.name(), 3, GL_FLOAT, sizeof(Vertex), offsetof(Vertex, normal));
    out.array_.elements(out.indices_.name());
    out.bounds_ = mesh.bounds();
    out.count_ = static_cast<int>(mesh.indices.size());
    return out;
}

void GpuMesh::draw() const {
    array_.bind();
    glDrawElements(GL_TRIANGLES, count_, GL_UNSIGNED_INT, nullptr);
}

}  // namespace rivulet
