// PourBrush: the left button as a tap: water falls onto what the mouse points at, for as long as it is held.
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
    // One frame's input. `over`: a panel has the mouse. Whether the left button is the brush's.
    bool take(const InputEvents& input, const Camera& camera, Session& session, bool over);
    // A ring where the water will fall, by ImGui.
    void draw(const InputEvents& input, const Camera& camera, const Session& session) const;

  private:
    bool on_ = false, pours_ = false;
    std::optional<vec3> at_;  // m, what the mouse points at
};

// What a ray meets first of a scene: a solid, the water, or, inside the box, its far side. Nothing: it passes the box by.
std::optional<vec3> pouredOnto(Session& session, const vec3& origin, const vec3& direction);

}  // namespace rivulet
