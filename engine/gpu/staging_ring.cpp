#include "engine/gpu/staging_ring.h"

#include <rivulet_glad/gl.h>

#include "engine/core/assert.h"

namespace rivulet::gpu {

namespace {
constexpr size_t kAlignment = 64;  // bytes: a cache line, and the alignment of copies
}

Status StagingRing::begin(size_t bytes) {
    at_ = (at_ + 1) % kDeep;
    Slot& slot = slots_[at_];
    if (!slot.read.passed()) {
        ++waits_;
        slot.read.wait();
    }
    used_ = taken_ = 0;
    if (slot.memory.bytes() >= bytes && slot.memory) return ok();
    Result<Buffer> made = Buffer::create(bytes + bytes / 4, BufferKind::mapped);
    if (!made) return made.error();
    slot.memory = std::move(*made);
    return ok();
}

std::span<std::byte> StagingRing::take(size_t bytes) {
    const std::span<std::byte> all = slots_[at_].memory.mapped();
    taken_ = (used_ + kAlignment - 1) / kAlignment * kAlignment;
    ASSERT(taken_ + bytes <= all.size(), "begin() with as many bytes as are taken, and 64 for each slot taken");
    used_ = taken_ + bytes;
    return all.subspan(taken_, bytes);
}

void StagingRing::copyTo(Buffer& to) {
    ASSERT(used_ - taken_ <= to.bytes(), "copy into a buffer that is large enough");
    if (used_ > taken_)
        glCopyNamedBufferSubData(slots_[at_].memory.name(), to.name(), static_cast<GLintptr>(taken_), 0,
                                 static_cast<GLsizeiptr>(used_ - taken_));
}

size_t StagingRing::bytes() const {
    size_t sum = 0;
    for (const Slot& slot : slots_) sum += slot.memory.bytes();
    return sum;
}

void StagingRing::end() { slots_[at_].read = Fence::now(); }

}  // namespace rivulet::gpu
