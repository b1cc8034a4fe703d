// Manipulator: what a person takes hold of in the picture. Bodies are grabbed and thrown while water flows; meshes, emitters and sinks are
// chosen by a click or in the tree, and moved and turned by the handles that then stand on them.
#pragma once

#include <optional>

#include "engine/app/input_events.h"
#include "engine/scene/camera.h"
#include "fluid/session/session.h"

namespace rivulet {

// From the camera through a place of the window, in lengths of its own.
struct ViewRay {
    vec3 origin{0.0F}, direction{0.0F};
    vec3 at(float t) const { return origin + direction * t; }
};
ViewRay rayThrough(const Camera& camera, const vec2& mouse, const vec2& size);
// The place in the window where `p` is seen; nothing: behind the camera.
std::optional<vec2> seenAt(const Camera& camera, const vec3& p, const vec2& size);

class Manipulator {
  public:
    using Thing = Session::Thing;
    // What an edit of the scene needs.
    struct Asks {
        bool mouse = false;     // it is the hand's: the camera stays
        bool edited = false;    // a value was changed that the world takes while it runs
        bool recreate = false;  // one was that a new world needs
    };
    // One frame's input, over no panel. Changes `draft` where things are moved.
    Asks take(const InputEvents& input, const Camera& camera, Session& session, SceneFile& draft);
    // Back to before the last move of a thing. false: there is none.
    bool undo(SceneFile& draft, Asks& asks);
    // Over the picture, under the panels, by ImGui.
    void draw(const InputEvents& input, const Camera& camera, const Session& session, const SceneFile& draft) const;

    const Thing& chosen() const { return chosen_; }
    void choose(const Thing& thing) { chosen_ = thing; }
    bool holds() const { return held_ || move_; }  // the mouse is its, also over a panel
    // The session is another one: a body that was in the hand is gone. A thing that is being moved by its handles still is.
    void letGo();

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
        float begin = 0;                      // m along the axis, or rad about it, where it was taken
    };
    struct Held {
        BulletSolids::Hold hold;
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
        vec3 movedTo{0.0F};  // whatever else stands under its number by now is left alone
    };
    std::optional<Before> before_;
    vec2 pressedAt_{0.0F};
    bool mayChoose_ = false;
};

}  // namespace rivulet
