// AdaptiveQuality: whether look.quality auto is fast or fine, by what frames cost to draw: the picture gives way before the frame rate
// does.
#pragma once

namespace rivulet {

class AdaptiveQuality {
  public:
    static constexpr double kMost = 12;  // ms: what is left of a 60th of a second beside the simulation
    // A frame has cost `ms` to draw, >= 0. Frames in a row that cost more make it fast; many that would leave room for the fine picture,
    // which costs up to four times the fast one's, make it fine again. Each time that turns out wrong it waits twice as long before the
    // next.
    void frame(double ms);
    // From the start, or again from there: fast where software draws.
    void begin(bool software);
    bool fast() const { return fast_; }

  private:
    bool fast_ = false;
    int slow_ = 0, roomy_ = 0, patience_ = 120;  // frames
};

}  // namespace rivulet
