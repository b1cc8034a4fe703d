// TearPoints: rings on a skin where its tears start. A person drags one along the skin, and the next tear starts there.
#pragma once

#include <optional>
#include <vector>

#include "engine/app/input_events.h"
#include "engine/scene/camera.h"
#include "fluid/session/session.h"

namespace rivulet {

class TearPoints {
  public:
    // The input of one frame, outside the panels; changes a source's position in `draft`. `edited`: it did. Whether it uses the mouse.
    bool take(const InputEvents& input, const Camera& camera, Session& session, SceneFile& draft, bool& edited);
    // Over the picture, by ImGui: the ring under the mouse or in its hold, and faintly the others while the mouse is near the skin.
    void draw(const InputEvents& input, const Camera& camera, Session& session) const;
    bool holds() const { return held_.has_value(); }
    void release() { held_.reset(); }

  private:
    struct Point {
        size_t skin = 0, source = 0;
        vec2 at{0.0F};  // window coordinates
    };
    static std::vector<Point> pointsOf(const Camera& camera, Session& session, const vec2& size);
    std::optional<Point> held_;
};

}  // namespace rivulet
