// PanelLayer: the layer of Dear ImGui over the picture, the size of its text, and what it costs.
#pragma once

#include <utility>

#include "engine/app/ui_layer.h"
#include "engine/gpu/timer.h"

namespace rivulet {

class PanelLayer {
  public:
    explicit PanelLayer(UiLayer ui) : ui_(std::move(ui)) {}
    void begin(InputEvents input, double seconds);
    void made();  // all windows of this frame are described
    // Over what is in the framebuffer, of this size in pixels; 0: ends ImGui's frame and draws nothing.
    void draw(unsigned framebuffer, int width, int height);
    bool wantsMouse() const { return ui_.wantsMouse(); }
    bool wantsKeyboard() const { return ui_.wantsKeyboard(); }
    void enlarge(float factor);          // of the text; 0: as at the start. It stays within half and four times that
    double ms() const { return uiMs_; }  // on the GPU, of a frame some frames ago

    // ms on the CPU for the last frame's panels: describing them, and handing them to OpenGL.
    struct Cost {
        double made = 0, drawn = 0;
    };
    const Cost& cost() const { return cost_; }

  private:
    void drawTimed();

    UiLayer ui_;
    gpu::Timer timer_;
    double uiMs_ = 0, began_ = 0;  // ms; s of threadSeconds()
    Cost cost_;
    float zoom_ = 1;
};

}  // namespace rivulet
