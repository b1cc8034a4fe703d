// The mouse over the picture: it turns, moves and zooms the camera, and a click puts a drop on a skin.
#pragma once

#include "engine/app/input_events.h"
#include "fluid/session/session.h"

namespace rivulet {

// A left drag turns the camera about its target, a right or middle drag moves both, the wheel changes the distance (1 mm to 10 km).
// `bounds`: of what is seen, m. Whether the camera was changed.
bool moveCamera(const InputEvents& input, const Bounds& bounds, CameraParams& camera);

class SkinClick {
  public:
    // A left click, not a drag, drips onto the skin under the mouse.
    void take(const InputEvents& input, const CameraParams& camera, Session& session);

  private:
    vec2 pressedAt_{0.0F};  // window coordinates
};

}  // namespace rivulet
