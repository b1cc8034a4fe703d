// PourBrush: pours water onto the point under the mouse while the left button is held.
#pragma once

#include <optional>

#include "engine/app/input_events.h"
#include "engine/scene/camera.h"
#include "fluid/session/session.h"

namespace rivulet {

class PourBrush {
  public:
    bool on() const { return on_; }
    bool pours() const { return pours_; }
    void turn(bool on) { on_ = on; }
    // The input of one frame. `over`: a panel has the mouse. Returns whether the brush uses the left button.
    bool take(const InputEvents& input, const Camera& camera, Session& session, bool over);
    // Draws a ring where the water starts and a line to where it falls, with ImGui.
    void draw(const InputEvents& input, const Camera& camera, const Session& session) const;

  private:
    bool on_ = false, pours_ = false;
    std::optional<vec3> at_;  // m, what the mouse points at
};

// The first hit of a ray (m, world): a solid, the water, or the far side of the box. Nothing: it misses the box.
std::optional<vec3> pouredOnto(Session& session, const vec3& origin, const vec3& direction);

}  // namespace rivulet
