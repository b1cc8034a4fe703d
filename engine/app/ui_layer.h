// UiLayer: Dear ImGui on a GL context, fed from InputEvents alone, so that a test can drive it without a window.
#pragma once

#include <memory>

#include "engine/app/input_events.h"
#include "engine/core/result.h"

namespace rivulet {

class UiLayer {
  public:
    // Needs a current OpenGL 4.5 context, until destroyed. `clipboard`: a GLFW window that lends its clipboard; may be null.
    // Error (failed): the driver refuses ImGui's shaders.
    static Result<UiLayer> create(void* clipboard = nullptr);
    UiLayer(UiLayer&&) noexcept;
    UiLayer& operator=(UiLayer&&) noexcept;
    ~UiLayer();

    // Between begin and draw, ImGui's own functions add windows. `seconds` since the last frame.
    void begin(const InputEvents& input, double seconds);
    // Over what is in the framebuffer that is bound; leaves GL's state as it was. A window of size 0: nothing is drawn.
    void draw();

    bool wantsMouse() const;     // the mouse is over a panel: it is no camera movement
    bool wantsKeyboard() const;  // a text field has the keyboard: keys are no commands

  private:
    struct Impl;
    explicit UiLayer(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace rivulet
