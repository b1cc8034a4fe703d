#include "engine/gpu/vertex_array.h"

#include <rivulet_glad/gl.h>

namespace rivulet::gpu {
namespace {

// Binding point = location: no two attributes share one.
void feed(GLuint array, GLuint location, GLuint buffer, int stride, size_t offset, int divisor) {
    glEnableVertexArrayAttrib(array, location);
    glVertexArrayVertexBuffer(array, location, buffer, static_cast<GLintptr>(offset), stride);
    glVertexArrayAttribBinding(array, location, location);
    glVertexArrayBindingDivisor(array, location, static_cast<GLuint>(divisor));
}

}  // namespace

VertexArray VertexArray::create() {
    VertexArray array;
    GLuint name = 0;
    glCreateVertexArrays(1, &name);
    array.name_ = VertexArrayName(name);
    return array;
}

void VertexArray::attribute(GLuint location, GLuint buffer, int components, GLenum type, int stride, size_t offset, int divisor) {
    glVertexArrayAttribFormat(name(), location, components, type, GL_FALSE, 0);
    feed(name(), location, buffer, stride, offset, divisor);
}

void VertexArray::integerAttribute(GLuint location, GLuint buffer, int components, GLenum type, int stride, size_t offset, int divisor) {
    glVertexArrayAttribIFormat(name(), location, components, type, 0);
    feed(name(), location, buffer, stride, offset, divisor);
}

void VertexArray::elements(GLuint buffer) { glVertexArrayElementBuffer(name(), buffer); }

void VertexArray::bind() const { glBindVertexArray(name()); }

}  // namespace rivulet::gpu
