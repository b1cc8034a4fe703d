// GpuMesh: a mesh's triangles in GPU memory, ready to draw.
#pragma once

#include "engine/compute/gl_sharing.h"
#include "engine/gpu/buffer.h"
#include "engine/gpu/vertex_array.h"
#include "engine/scene/mesh.h"
#include "engine/scene/skin.h"

namespace rivulet {

class GpuMesh {
  public:
    // Attribute 0: position, 1: normal (zero where the mesh has none), w: mean curvature (1/m, of the mesh's unit), 2: uv (zero where it
    // has none). Error (failed): out of GPU memory.
    static Result<GpuMesh> create(const Mesh& mesh);
    // Uses the deformer's vertices: its own buffers if it runs on OpenGL, else copies, which are updated only after it has run again; on
    // OpenCL that shares no memory with OpenGL this waits. It must have the same number of vertices and outlive the drawing. Error
    // (failed): out of GPU memory.
    Status follow(const Deformer& deformer);
    // The same with vertices that have been read: never waits.
    Status follow(const DeformedVertices& vertices);
    void draw() const;                                // draws with the program in use
    const Bounds& bounds() const { return bounds_; }  // of the mesh, or of the deformer

  private:
    // OpenGL's copies of a deformer's positions and normals, and OpenCL's view of them, which is released first.
    struct Copies {
        gpu::Buffer buffers[2];
        GlSharing::Wrapped seen[2];
    };
    Status makeRoom(size_t bytes);
    bool share(const Deformer& deformer);
    void attach(unsigned positions, unsigned normals);

    gpu::Buffer vertices_, indices_;
    Copies copies_;
    bool unshared_ = false;  // sharing has failed
    uint64_t followed_ = 0;  // the deformer's version
    gpu::VertexArray array_;
    Bounds bounds_;
    int count_ = 0;
};

}  // namespace rivulet
