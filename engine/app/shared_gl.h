// SharedGl: a second OpenGL context whose buffers, textures and programs are those of the first, for work on another thread.
#pragma once

#include <functional>
#include <memory>

namespace rivulet {

// Framebuffers, vertex arrays and queries are not shared: their owner must be notified when the thread changes (contextChanged of
// device_gl.h).
struct SharedGl {
    std::function<bool()> enter;    // makes it current on the calling thread, which has none; waits while another has it. false: it cannot
    std::function<void()> leave;    // none is current there any more
    std::shared_ptr<void> context;  // goes last, on the thread that made it
    explicit operator bool() const { return context != nullptr; }
};

}  // namespace rivulet
