#include "engine/gpu/host_buffer.h"

#include <fmt/format.h>
#include <rivulet_glad/gl.h>

namespace rivulet::gpu {

Result<size_t> hostBufferSize(uint32_t name, const std::string& what) {
    if (glIsBuffer(name) == GL_FALSE)
        return badInput(fmt::format("{} is {}, which is not the name of a buffer in the current OpenGL context", what, name));
    GLint64 bytes = 0;
    glGetNamedBufferParameteri64v(name, GL_BUFFER_SIZE, &bytes);
    GLint mapped = GL_FALSE, flags = 0;
    glGetNamedBufferParameteriv(name, GL_BUFFER_MAPPED, &mapped);
    glGetNamedBufferParameteriv(name, GL_BUFFER_ACCESS_FLAGS, &flags);
    if (mapped == GL_TRUE && (flags & GL_MAP_PERSISTENT_BIT) == 0)
        return badInput(fmt::format("{} is mapped: unmap it before the call, or map it with GL_MAP_PERSISTENT_BIT", what));
    return static_cast<size_t>(bytes);
}

void copyHostBuffer(uint32_t from, uint32_t to, size_t bytes) {
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    glCopyNamedBufferSubData(from, to, 0, 0, static_cast<GLsizeiptr>(bytes));
}

void readHostBuffer(uint32_t from, std::span<std::byte> to) {
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    glGetNamedBufferSubData(from, 0, static_cast<GLsizeiptr>(to.size()), to.data());
}

}  // namespace rivulet::gpu
