// Fence: reports whether the GPU has finished all commands issued before it.
#pragma once

#include <rivulet_glad/gl.h>

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
    ~Fence() {
        if (sync_ && !LostContext::here()) glDeleteSync(sync_);
    }
    // A fence behind all commands issued so far.
    static Fence now() {
        Fence fence;
        fence.sync_ = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
        if (!fence.sync_) glFinish();  // no fence could be made: after glFinish() all commands have passed
        return fence;
    }
    bool passed() const { return reached(0); }
    void wait() const {
        while (!reached(1'000'000'000)) {
        }
    }

  private:
    // A lost context returns GL_WAIT_FAILED, which counts as reached: there is nothing to wait for.
    bool reached(GLuint64 nanoseconds) const {
        return !sync_ || glClientWaitSync(sync_, GL_SYNC_FLUSH_COMMANDS_BIT, nanoseconds) != GL_TIMEOUT_EXPIRED;
    }

    GLsync sync_ = nullptr;
};

}  // namespace rivulet::gpu
