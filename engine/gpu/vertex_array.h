// VertexArray: which buffers feed a vertex shader, and how. Buffers are named, not owned: they may be any owner's.
#pragma once

#include <cstddef>

#include "engine/gpu/gl_object.h"

namespace rivulet::gpu {

class VertexArray {
  public:
    VertexArray() = default;
    static VertexArray create();  // without attributes: what a full-screen triangle from gl_VertexID needs

    // Attribute `location` = `components` numbers of `type` (GL_FLOAT; integers are converted to float) every `stride` bytes.
    // divisor 1: a value per instance instead of per vertex.
    void attribute(GLuint location, GLuint buffer, int components, GLenum type, int stride, size_t offset = 0, int divisor = 0);
    // The same for `in uint`, `in ivec2` ...: integers stay integers.
    void integerAttribute(GLuint location, GLuint buffer, int components, GLenum type, int stride, size_t offset = 0, int divisor = 0);
    void elements(GLuint buffer) { glVertexArrayElementBuffer(name(), buffer); }

    GLuint name() const { return name_.name(); }
    explicit operator bool() const { return static_cast<bool>(name_); }
    void bind() const { glBindVertexArray(name()); }
    void letGo() { name_.letGo(); }  // it was made in another context, with which it goes

  private:
    VertexArrayName name_;
};

}  // namespace rivulet::gpu
