// TimelinePanel: the last spans of a Timeline, one row per lane, so that overlaps are visible.
#pragma once

#include "engine/core/timeline.h"

namespace rivulet {

class TimelinePanel {
  public:
    // Two frames of `frame` s each, as long ago as a GPU's spans come late. `width`: pixels; inside an ImGui window.
    void draw(const Timeline& timeline, double frame, float width);

  private:
    bool held_ = false;  // by the mouse over it, so that it can be read
    double until_ = 0;   // s, the right edge
    double shown_ = 0;   // s across
};

}  // namespace rivulet
