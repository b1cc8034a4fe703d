// GlSharing: copies an OpenCL device's Buffers into OpenGL buffers, so that simulated data is drawn without a copy through the host.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "engine/compute/device.h"
#include "engine/core/result.h"

namespace rivulet {

// The OpenGL context that is current on this thread, and the OpenGL functions that sharing needs. Plain data, because engine/compute does
// not include OpenGL; gpu::currentContext() fills it.
struct GlContext {
    void* context = nullptr;                     // an EGLContext or a GLXContext; null: none is current
    void* display = nullptr;                     // an EGLDisplay, or an X11 Display*
    bool egl = true;                             // else GLX
    unsigned (*create)(size_t bytes) = nullptr;  // a buffer's name; 0: out of memory
    void (*write)(unsigned buffer, std::span<const std::byte> bytes) = nullptr;
    void (*read)(unsigned buffer, std::span<std::byte> bytes) = nullptr;
    void (*destroy)(unsigned buffer) = nullptr;
    void (*finish)() = nullptr;  // waits for all OpenGL commands issued so far
};

// Belongs to one Device and the OpenGL context that the Device was made with, which must be current in every call. GlSharing and Wrapped
// buffers may outlive the Device: they keep OpenCL's objects alive.
class GlSharing {
  public:
    struct Impl;
    explicit GlSharing(std::unique_ptr<Impl> impl);
    ~GlSharing();

    // OpenCL's object for an OpenGL buffer; destroy it before the buffer is deleted. Error (failed): a message without final period.
    using Wrapped = std::shared_ptr<void>;
    Result<Wrapped> wrap(unsigned buffer) const;

    struct Copy {
        const Buffer* from;  // of the Device
        const Wrapped* to;
        size_t bytes;
    };
    // Copies the first `bytes` of each `from`, after all earlier commands of the Device; acquires and releases all buffers once. Later
    // OpenGL commands see the copies. Waits for OpenGL, then for OpenCL, but not where the driver offers cl_khr_gl_event. Error (failed):
    // then the contents of the OpenGL buffers are undefined.
    Status copy(std::span<const Copy> copies) const;

  private:
    std::unique_ptr<Impl> impl_;
};

}  // namespace rivulet
