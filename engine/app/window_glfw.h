// WindowGlfw: a window with an OpenGL 4.5 core context.
#pragma once

#include <memory>
#include <string>

#include "engine/app/input_events.h"
#include "engine/app/shared_gl.h"
#include "engine/core/result.h"

struct GLFWwindow;

namespace rivulet {

// One at a time, on the main thread, with no ContextEgl current there; its context is current on it. ImGui_ImplGlfw_InitForOpenGL(handle(),
// true) chains to this window's callbacks.
class WindowGlfw {
  public:
    struct Options {
        std::string title = "rivulet";
        int width = 1280, height = 720;
        bool scaled = false;  // width and height are of an ordinary screen: more pixels where text is larger
        bool visible = true;
        bool vsync = true;
        bool debug = false;  // drivers say more, and are slower
    };
    // Error (failed): no display, no OpenGL 4.5; says which. Loads the GL functions (glad).
    static Result<WindowGlfw> create(const Options& options);
    WindowGlfw(WindowGlfw&&) noexcept;
    WindowGlfw& operator=(WindowGlfw&&) noexcept;
    ~WindowGlfw();

    // Returns the events since the last call, without waiting.
    InputEvents poll();
    // Must be created and destroyed on the main thread. Error (failed): the driver cannot create a second context.
    Result<SharedGl> shared() const;
    void swap();  // shows the content of framebuffer 0
    void setTitle(const std::string& title);
    void resize(int width, int height);  // window coordinates
    GLFWwindow* handle() const;
    bool software() const;  // GL runs on the CPU
    const std::string& renderer() const;

  private:
    struct Impl;
    explicit WindowGlfw(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace rivulet
