// Buffer: GPU memory of a fixed size.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/core/result.h"
#include "engine/gpu/gl_object.h"

namespace rivulet::gpu {

// mapped: the host can access the memory at any time (persistent, coherent). The caller must use a Fence before it overwrites data that the
// GPU may still read.
enum class BufferKind { plain, mapped };

class Buffer {
  public:
    Buffer() = default;
    // A buffer filled with zeros. 0 bytes give a valid buffer of 0 bytes. Error (failed): out of memory, with the requested size.
    static Result<Buffer> create(size_t bytes, BufferKind kind = BufferKind::plain);
    template <class T>
    static Result<Buffer> from(std::span<const T> items) {
        return fromBytes(std::as_bytes(items));
    }
    template <class T>
    static Result<Buffer> from(const std::vector<T>& items) {
        return fromBytes(std::as_bytes(std::span(items)));
    }

    unsigned name() const { return name_.name(); }
    unsigned release() { return name_.release(); }  // the caller owns the name now; the Buffer is empty
    size_t bytes() const { return bytes_; }
    explicit operator bool() const { return static_cast<bool>(name_); }

    // In order with draws and copies; not with dispatches that still read the buffer, which a driver is known to let a write overtake (use
    // Device::write for what kernels read). create(), from() and fill() never wait for the GPU, write() only after create() or fill() of a
    // plain buffer, with 64 KiB or more; read() does.
    void write(std::span<const std::byte> bytes, size_t offset = 0);
    void read(std::span<std::byte> bytes, size_t offset = 0) const;
    void fill(uint32_t word);  // every 4 bytes
    template <class T>
    void writeAll(std::span<const T> items) {
        write(std::as_bytes(items));
    }
    template <class T>
    std::vector<T> readAll(size_t count) const {
        std::vector<T> items(count);
        read(std::as_writable_bytes(std::span(items)));
        return items;
    }
    std::span<std::byte> mapped() const { return {mapped_, mapped_ ? bytes_ : 0}; }  // empty unless BufferKind::mapped

    // `target`: GL_SHADER_STORAGE_BUFFER or GL_UNIFORM_BUFFER.
    void bind(unsigned target, unsigned binding) const;

  private:
    static Result<Buffer> make(size_t bytes, BufferKind kind, const std::byte* content);
    static Result<Buffer> makeOf(std::span<const std::byte> first, size_t bytes, BufferKind kind);
    static Result<Buffer> fromBytes(std::span<const std::byte> bytes);
    BufferName name_;
    size_t bytes_ = 0;
    std::byte* mapped_ = nullptr;
    bool cleared_ = false;  // see kWriteOvertakesClear
};

}  // namespace rivulet::gpu
