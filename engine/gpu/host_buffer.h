// An OpenGL buffer of the host, which Rivulet reads and never changes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "engine/core/result.h"

namespace rivulet::gpu {

// Error (badInput): the name is none of a buffer in the current context, or the buffer cannot be copied from because it is mapped without
// GL_MAP_PERSISTENT_BIT. `what` names it in the message. Returns its size, bytes.
Result<size_t> hostBufferSize(uint32_t name, const std::string& what);

// Both see what shaders have written before: a memory barrier is included. The buffer has at least that many bytes.
void copyHostBuffer(uint32_t from, uint32_t to, size_t bytes);  // to another buffer, on the GPU
void readHostBuffer(uint32_t from, std::span<std::byte> to);    // waits for the GPU

}  // namespace rivulet::gpu
