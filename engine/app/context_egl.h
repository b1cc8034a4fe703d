// ContextEgl: an OpenGL 4.5 context without a window or a display.
#pragma once

#include <memory>
#include <string>

#include "engine/app/shared_gl.h"
#include "engine/core/result.h"

namespace rivulet {

// Current on the thread that made it, until destroyed. Tries Mesa's surfaceless platform, then each EGL device (NVIDIA's driver offers this
// one), then the default display; a GPU wins over a software renderer.
class ContextEgl {
  public:
    struct Options {
        bool debug = false;          // drivers say more, and are slower
        bool compatibility = false;  // with OpenGL's old functions, as hosts may have it
    };
    // Error (failed): no EGL, no OpenGL 4.5; says what was found. Loads the GL functions (glad).
    static Result<ContextEgl> create(const Options& options);
    static Result<ContextEgl> create() { return create(Options{}); }
    ContextEgl(ContextEgl&&) noexcept;
    ContextEgl& operator=(ContextEgl&&) noexcept;
    ~ContextEgl();

    Status makeCurrent();                 // on the calling thread. Error (failed): it is current on another
    Result<SharedGl> shared() const;      // current nowhere yet. Error (failed): the driver cannot create a second context
    bool software() const;                // llvmpipe, softpipe, swrast: GL runs on the CPU
    const std::string& renderer() const;  // GL_RENDERER
    const std::string& version() const;   // GL_VERSION
    const char* platform() const;         // "surfaceless", "device", "default"

  private:
    struct Impl;
    explicit ContextEgl(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace rivulet
