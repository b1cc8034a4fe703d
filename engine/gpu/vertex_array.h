// VertexArray: the buffers that a vertex shader reads, and their layout. Buffers are referred to by name and not owned.
#pragma once

#include <cstddef>

#include "engine/gpu/gl_object.h"

namespace rivulet::gpu {

class VertexArray {
  public:
    VertexArray() = default;
    static VertexArray create();  // without attributes, for example for a full-screen triangle from gl_VertexID

    // Attribute `location` = `components` numbers of `type` (GL_FLOAT; integers are converted to float) every `stride` bytes.
    // divisor 1: one value per instance instead of per vertex.
    void attribute(unsigned location, unsigned buffer, int components, unsigned type, int stride, size_t offset = 0, int divisor = 0);
    // The same for `in uint`, `in ivec2` ...: integers stay integers.
    void integerAttribute(unsigned location, unsigned buffer, int components, unsigned type, int stride, size_t offset = 0,
                          int divisor = 0);
    void elements(unsigned buffer);

    unsigned name() const { return name_.name(); }
    explicit operator bool() const { return static_cast<bool>(name_); }
    void bind() const;
    void release() { name_.release(); }  // drops the name without deleting it: another context owns it and deletes it

  private:
    VertexArrayName name_;
};

}  // namespace rivulet::gpu
