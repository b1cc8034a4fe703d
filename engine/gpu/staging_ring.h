// StagingRing: uploads data to the GPU in every frame without waiting: three mapped buffers used in turn, each with a fence.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "engine/core/result.h"
#include "engine/gpu/buffer.h"
#include "engine/gpu/fence.h"

namespace rivulet::gpu {

class StagingRing {
  public:
    static constexpr size_t kDeep = 3;

    // Starts the next buffer, of at least `bytes` bytes. Waits only if the GPU has not yet read the data of three frames ago; waits()
    // counts this. Error (failed): out of memory.
    Status begin(size_t bytes);
    // Reserves `bytes` bytes of the buffer for the host to write; between begin() and end().
    std::span<std::byte> take(size_t bytes);
    // Copies the bytes of the last take() to the beginning of `to`, on the GPU.
    void copyTo(Buffer& to);
    void end();

    uint64_t waits() const { return waits_; }
    size_t bytes() const;

  private:
    struct Slot {
        Buffer memory;
        Fence read;
    };
    std::array<Slot, kDeep> slots_;
    size_t at_ = 0, used_ = 0, taken_ = 0;  // index of the buffer; bytes used of it; offset of the last take()
    uint64_t waits_ = 0;
};

}  // namespace rivulet::gpu
