// Fence: reports whether the GPU has finished all commands issued before it.
#pragma once

#include <cstdint>
#include <utility>

#include "engine/gpu/lost_context.h"

namespace rivulet::gpu {

class Fence {
  public:
    Fence() = default;
    Fence(Fence&& other) noexcept : sync_(std::exchange(other.sync_, nullptr)) {}
    Fence& operator=(Fence&& other) noexcept {
        std::swap(sync_, other.sync_);
        return *this;
    }
    ~Fence();
    static Fence now();  // behind all commands issued so far
    bool passed() const { return reached(0); }
    void wait() const;

  private:
    bool reached(uint64_t nanoseconds) const;

    void* sync_ = nullptr;  // a GLsync
};

}  // namespace rivulet::gpu
