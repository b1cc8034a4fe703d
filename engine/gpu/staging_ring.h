// StagingRing: how the host hands data to the GPU every frame without waiting: mapped memory, three pieces in turn, a fence for each.
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

    // The next piece, of at least so many bytes. Waits only where the GPU has not yet read what was written three frames ago, and
    // waits() counts that. Error (failed): out of memory.
    Status begin(size_t bytes);
    // So many bytes of the piece, for the host to write; between begin() and end().
    std::span<std::byte> take(size_t bytes);
    // Copies what take() gave last into the beginning of `to`, on the GPU.
    void copyTo(Buffer& to);
    void end();

    uint64_t waits() const { return waits_; }
    size_t bytes() const;

  private:
    struct Piece {
        Buffer memory;
        Fence read;
    };
    std::array<Piece, kDeep> pieces_;
    size_t at_ = 0, used_ = 0, taken_ = 0;  // the piece; bytes of it; where the last that was taken begins
    uint64_t waits_ = 0;
};

}  // namespace rivulet::gpu
