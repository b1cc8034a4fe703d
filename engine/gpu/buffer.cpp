#include "engine/gpu/buffer.h"

#include <fmt/format.h>
#include <rivulet_glad/gl.h>

#include <algorithm>
#include <memory>
#include <new>
#include <utility>

#include "engine/core/assert.h"
#include "engine/gpu/gl_error.h"

namespace rivulet::gpu {
namespace {

// NVIDIA's driver 580 lets a glNamedBufferSubData of this many bytes overtake an earlier glClearNamedBufferData of the buffer, which then
// wipes the data out: before such a write, glFinish() ends the clear. Shorter writes were in order.
constexpr size_t kWriteOvertakesClear = 65536;

// GL refuses buffers of 0 bytes, fills are done in 4-byte words, and std140 blocks have a size of 16 n bytes.
size_t paddedBytes(size_t bytes) { return std::max<size_t>((bytes + 15) / 16 * 16, 16); }

}  // namespace

Result<Buffer> Buffer::create(size_t bytes, BufferKind kind) {
    if (kind == BufferKind::plain) return make(bytes, kind, nullptr);
    // Zeros from the host: the GPU would have to end a clear before the host may write.
    return makeOf({}, bytes, kind);
}

Result<Buffer> Buffer::fromBytes(std::span<const std::byte> bytes) {
    if (bytes.size() == paddedBytes(bytes.size())) return make(bytes.size(), BufferKind::plain, bytes.data());
    return makeOf(bytes, bytes.size(), BufferKind::plain);
}

// Of these bytes, and zeros behind them.
Result<Buffer> Buffer::makeOf(std::span<const std::byte> first, size_t bytes, BufferKind kind) {
    const std::unique_ptr<std::byte[]> padded(new (std::nothrow) std::byte[paddedBytes(bytes)]());
    if (!padded) return failed(fmt::format("the host is out of memory: {} bytes for a buffer", bytes));
    std::ranges::copy(first, padded.get());
    return make(bytes, kind, padded.get());
}

// `content`: of the padded size; null: it is cleared on the GPU.
Result<Buffer> Buffer::make(size_t bytes, BufferKind kind, const std::byte* content) {
    clearGlErrors();
    Buffer buffer;
    GLuint name = 0;
    glCreateBuffers(1, &name);
    buffer.name_ = BufferName(name);
    buffer.bytes_ = bytes;
    const GLbitfield mapping = GL_MAP_READ_BIT | GL_MAP_WRITE_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
    const GLbitfield flags = GL_DYNAMIC_STORAGE_BIT | (kind == BufferKind::mapped ? mapping : 0);
    const size_t padded = paddedBytes(bytes);
    glNamedBufferStorage(name, static_cast<GLsizeiptr>(padded), content, flags);
    GLenum error = takeGlError();
    if (error == GL_NO_ERROR) {
        if (content == nullptr) buffer.fill(0);  // drivers that allocate late fail here
        if (kind == BufferKind::mapped)
            buffer.mapped_ = static_cast<std::byte*>(glMapNamedBufferRange(name, 0, static_cast<GLsizeiptr>(padded), mapping));
        error = takeGlError();
    }
    if (error != GL_NO_ERROR || (kind == BufferKind::mapped && !buffer.mapped_))
        return failed(fmt::format(
            "the GPU is out of memory: cannot allocate a buffer of {} bytes ({:.1f} MiB; {}); use fewer particles or coarser voxels", bytes,
            static_cast<double>(bytes) / 1048576.0, glErrorName(error)));
    return buffer;
}

void Buffer::write(std::span<const std::byte> bytes, size_t offset) {
    ASSERT(offset <= bytes_ && bytes.size() <= bytes_ - offset, "write inside the buffer");
    if (bytes.empty()) return;
    if (bytes.size() >= kWriteOvertakesClear && cleared_) {
        glFinish();
        cleared_ = false;
    }
    glNamedBufferSubData(name(), static_cast<GLintptr>(offset), static_cast<GLsizeiptr>(bytes.size()), bytes.data());
}

void Buffer::read(std::span<std::byte> bytes, size_t offset) const {
    ASSERT(offset <= bytes_ && bytes.size() <= bytes_ - offset, "read inside the buffer");
    if (bytes.empty()) return;
    glGetNamedBufferSubData(name(), static_cast<GLintptr>(offset), static_cast<GLsizeiptr>(bytes.size()), bytes.data());
}

void Buffer::fill(uint32_t word) {
    ASSERT(name() != 0, "create the buffer before filling it");
    cleared_ = true;
    glClearNamedBufferData(name(), GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, &word);
}

void Buffer::bind(GLenum target, GLuint binding) const { glBindBufferBase(target, binding, name()); }

}  // namespace rivulet::gpu
