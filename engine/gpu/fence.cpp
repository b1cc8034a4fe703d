#include "engine/gpu/fence.h"

#include <rivulet_glad/gl.h>

namespace rivulet::gpu {

Fence::~Fence() {
    if (sync_ && !LostContext::here()) glDeleteSync(static_cast<GLsync>(sync_));
}

Fence Fence::now() {
    Fence fence;
    fence.sync_ = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
    if (!fence.sync_) glFinish();  // no fence could be made: after glFinish() all commands have passed
    return fence;
}

void Fence::wait() const {
    while (!reached(1'000'000'000)) {
    }
}

// A lost context returns GL_WAIT_FAILED, which counts as reached: there is nothing to wait for.
bool Fence::reached(uint64_t nanoseconds) const {
    return !sync_ || glClientWaitSync(static_cast<GLsync>(sync_), GL_SYNC_FLUSH_COMMANDS_BIT, nanoseconds) != GL_TIMEOUT_EXPIRED;
}

}  // namespace rivulet::gpu
