// Manipulator: moves objects with the mouse. Bodies are grabbed and thrown while the water flows. Meshes, emitters and sinks are selected
// by a click or in the tree, and moved and rotated by the handles that then appear.
#pragma once

#include <optional>

#include "engine/app/input_events.h"
#include "engine/scene/camera.h"
#include "fluid/session/session.h"

namespace rivulet {

// A ray from the camera through a point of the window; m, world; `direction` is not normalised.
struct ViewRay {
    vec3 origin{0.0F}, direction{0.0F};
    vec3 at(float t) const { return origin + direction * t; }
};
ViewRay rayThrough(const Camera& camera, const vec2& mouse, const vec2& size);
// The point of the window where `p` (m, world) appears; nothing: it is behind the camera.
std::optional<vec2> seenAt(const Camera& camera, const vec3& p, const vec2& size);

class Manipulator {
  public:
    using Thing = Session::Thing;
    // What the input asks of the caller.
    struct Asks {
        bool mouse = false;     // the manipulator uses the mouse: the camera stays
        bool edited = false;    // a live value was changed
        bool recreate = false;  // a fixed value was changed: a new session is needed
    };
    // The input of one frame, outside the panels. Changes `draft` when an object is moved.
    Asks take(const InputEvents& input, const Camera& camera, Session& session, SceneFile& draft);
    // Undoes the last move of an object. Returns false if there is none.
    bool undo(SceneFile& draft, Asks& asks);
    // Over the picture, under the panels, by ImGui.
    void draw(const InputEvents& input, const Camera& camera, const Session& session, const SceneFile& draft) const;

    const Thing& chosen() const { return chosen_; }
    void choose(const Thing& thing) { chosen_ = thing; }
    bool holds() const { return held_ || move_; }  // it uses the mouse, also over a panel
    // The session is replaced: a body is no longer held. A move by handles continues.
    void release();

  private:
    struct Handles {
        vec3 centre{0.0F};
        float length = 1;  // m, of an arrow
    };
    enum class Part { none, alongX, alongY, alongZ, aboutX, aboutY, aboutZ };
    struct Move {
        Part part = Part::none;
        vec3 position{0.0F}, rotation{0.0F};  // as they were
        vec3 centre{0.0F};                    // of the handles, then
        float begin = 0;                      // m along the axis, or rad about it, where the drag began
    };
    struct Held {
        BodyPull hold;
        float depth = 0;  // m, along the camera's view
    };
    std::optional<Handles> handles(const Camera& camera, const Session& session, const SceneFile& draft) const;
    Part partAt(const Handles& handles, const Camera& camera, const vec2& mouse, const vec2& size, bool turns) const;
    void grab(const ViewRay& ray, const Camera& camera, Session& session);

    Thing chosen_;
    std::optional<Held> held_;
    std::optional<Move> move_;
    struct Before {
        Thing thing;
        vec3 position{0.0F}, rotation{0.0F};
        vec3 movedTo{0.0F};  // another object may have its index by now: it stays
    };
    std::optional<Before> before_;
    vec2 pressedAt_{0.0F};
    bool mayChoose_ = false;
};

}  // namespace rivulet
