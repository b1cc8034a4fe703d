// GlSharing: how an OpenCL device copies its Buffers into OpenGL's own, so that what it simulates is drawn without passing through the
// host.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "engine/compute/device.h"
#include "engine/core/result.h"

namespace rivulet {

// The OpenGL context that is current on this thread, as OpenCL is told of it, and what is asked of it. Plain data: engine/compute knows no
// OpenGL; gpu::currentContext() fills it.
struct GlContext {
    void* context = nullptr;                     // an EGLContext or a GLXContext; null: none is current
    void* display = nullptr;                     // an EGLDisplay, or an X11 Display*
    bool egl = true;                             // else GLX
    unsigned (*create)(size_t bytes) = nullptr;  // a buffer's name; 0: out of memory
    void (*write)(unsigned buffer, std::span<const std::byte> bytes) = nullptr;
    void (*read)(unsigned buffer, std::span<std::byte> bytes) = nullptr;
    void (*destroy)(unsigned buffer) = nullptr;
    void (*finish)() = nullptr;  // waits for all that OpenGL was told
};

// Of one Device and of the OpenGL context that it was made with, which must be current in every call. May outlive the Device, and so may
// what it has wrapped: both keep OpenCL's own objects alive.
class GlSharing {
  public:
    struct Impl;
    explicit GlSharing(std::unique_ptr<Impl> impl);
    ~GlSharing();

    // An OpenGL buffer as OpenCL sees it; to be let go before that buffer is deleted. Error (failed): half a sentence.
    using Wrapped = std::shared_ptr<void>;
    Result<Wrapped> wrap(unsigned buffer) const;

    struct Copy {
        const Buffer* from;  // of the Device
        const Wrapped* to;
        size_t bytes;
    };
    // The first so many bytes of each `from`, behind all that the Device was told before; acquires and releases all of them once. Waits for
    // OpenGL, then for OpenCL: whatever OpenGL is told next sees the copies. Error (failed): half a sentence; nothing can be said of what
    // the OpenGL buffers hold then.
    Status copy(std::span<const Copy> copies) const;

  private:
    std::unique_ptr<Impl> impl_;
};

}  // namespace rivulet
