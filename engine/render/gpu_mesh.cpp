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

void GpuMesh::attach(GLuint positions, GLuint normals) {
    array_.attribute(0, positions, 3, GL_FLOAT, sizeof(vec4));
    array_.attribute(1, normals, 4, GL_FLOAT, sizeof(vec4));
}

Status GpuMesh::makeRoom(size_t bytes) {
    for (size_t k = 0; k < 2; ++k) {
        if (copies_.buffers[k] && copies_.buffers[k].bytes() == bytes) continue;
        copies_.seen[k].reset();
        Result<gpu::Buffer> made = gpu::Buffer::create(bytes);
        if (!made) return made.error();
        copies_.buffers[k] = std::move(*made);
    }
    return ok();
}

// Lets OpenCL copy the vertices into OpenGL's memory. Returns false where they do not share it.
bool GpuMesh::share(const Deformer& deformer) {
    const std::shared_ptr<const GlSharing> by = unshared_ ? nullptr : deformer.device().glShare().by;
    if (!by) return false;
    const Buffer* const from[] = {&deformer.positions(), &deformer.normals()};
    std::vector<GlSharing::Copy> copies;
    for (size_t k = 0; k < 2 && !unshared_; ++k) {
        if (!copies_.seen[k]) {
            Result<GlSharing::Wrapped> seen = by->wrap(copies_.buffers[k].name());
            unshared_ = !seen;
            if (seen) copies_.seen[k] = std::move(*seen);
        }
        copies.push_back({from[k], &copies_.seen[k], copies_.buffers[k].bytes()});
    }
    unshared_ = unshared_ || !by->copy(copies);
    return !unshared_;
}

Status GpuMesh::follow(const Deformer& deformer) {
    Device& device = deformer.device();
    if (device.backend() == Backend::gl) {
        bounds_ = deformer.bounds();
        if (followed_ != deformer.version())
            attach(static_cast<GLuint>(deformer.positions().handle()), static_cast<GLuint>(deformer.normals().handle()));
        followed_ = deformer.version();
        return ok();
    }
    if (followed_ == deformer.version()) return ok();
    if (Status room = makeRoom(deformer.vertices() * sizeof(vec4)); !room) return room;
    if (!share(deformer))
        return follow(DeformedVertices{device.readAll<vec4>(deformer.positions(), deformer.vertices()),
                                       device.readAll<vec4>(deformer.normals(), deformer.vertices()),
                                       deformer.bounds(),
                                       deformer.version(),
                                       {}});
    bounds_ = deformer.bounds();
    attach(copies_.buffers[0].name(), copies_.buffers[1].name());
    followed_ = deformer.version();
    return ok();
}

Status GpuMesh::follow(const DeformedVertices& v) {
    if (followed_ == v.version || v.normals.empty()) return ok();
    if (Status room = makeRoom(v.positions.size() * sizeof(vec4)); !room) return room;
    copies_.buffers[0].writeAll(std::span<const vec4>(v.positions));
    copies_.buffers[1].writeAll(std::span<const vec4>(v.normals));
    bounds_ = v.bounds;
    attach(copies_.buffers[0].name(), copies_.buffers[1].name());
    followed_ = v.version;
    return ok();
}

void GpuMesh::draw() const {
    array_.bind();
    glDrawElements(GL_TRIANGLES, count_, GL_UNSIGNED_INT, nullptr);
}

}  // namespace rivulet
