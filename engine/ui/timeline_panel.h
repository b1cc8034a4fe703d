// The last moments of a Timeline, a lane a row: what overlaps is seen.
#pragma once

#include "engine/core/timeline.h"

namespace rivulet {

class TimelinePanel {
  public:
    void draw(const Timeline& timeline, float width);  // pixels; inside an ImGui window

  private:
    bool held_ = false;  // by the mouse over it, so that it can be read
    double until_ = 0;   // s, the right edge
};

}  // namespace rivulet
