// GpuMesh: a mesh's triangles in GPU memory, ready to draw.
#pragma once

#include "engine/gpu/buffer.h"
#include "engine/gpu/vertex_array.h"
#include "engine/scene/mesh.h"

namespace rivulet {

class GpuMesh {
  public:
    // Attribute 0: position, 1: normal (zero where the mesh has none). Error (failed): out of GPU memory.
    static Result<GpuMesh> create(const Mesh& mesh);
    void draw() const;                                // with the program in use
    const Bounds& bounds() const { return bounds_; }  // the mesh's own

  private:
    gpu::Buffer vertices_, indices_;
    gpu::VertexArray array_;
    Bounds bounds_;
    int count_ = 0;
};

}  // namespace rivulet
