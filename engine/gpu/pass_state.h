// PassState: what a pass of a frame graph draws with, and the state of OpenGL from pass to pass.
#pragma once

#include "engine/core/abi.h"

namespace rivulet::gpu {

// What a pass draws with; the defaults are OpenGL's. Blending is on where it differs from them, in the first two colours.
struct PassState {
    bool depthTest = false, depthWrites = true, colourWrites = true;
    unsigned depthFunction = 0x0201;                                    // GL_LESS
    unsigned blendSource = 1, blendTarget = 0, blendEquation = 0x8006;  // GL_ONE, GL_ZERO, GL_FUNC_ADD
    bool operator==(const PassState&) const = default;
};

// The state within FrameGraph::execute(). Framebuffer and viewport go back to those of the host at the end, the rest to OpenGL's defaults.
class StateScope {
  public:
    StateScope();
    ~StateScope();
    StateScope(const StateScope&) = delete;
    StateScope& operator=(const StateScope&) = delete;

    void set(const PassState& to);  // calls OpenGL for what differs from the last
    void reset();                   // after a pass that may have set anything

  private:
    void unbind() const;

    int draw_ = 0, read_ = 0;
    float viewport_[4] = {0, 0, 0, 0};
    PassState now_;
};

}  // namespace rivulet::gpu
