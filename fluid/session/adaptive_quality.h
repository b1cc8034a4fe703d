// AdaptiveQuality: whether look.quality auto is fast or fine, by the cost of drawing: quality drops before the frame rate does.
#pragma once

namespace rivulet {

class AdaptiveQuality {
  public:
    static constexpr double kMost = 12;  // ms: the share of 1/60 s for drawing, beside the simulation
    // A frame took `ms` >= 0 to draw. Consecutive frames above kMost switch to fast. Many frames that leave time for the fine picture,
    // which costs up to four times the fast one, switch back to fine. Each time that was wrong, the next attempt waits twice as long.
    void frame(double ms);
    // At the start and after a reset: fast where a software renderer draws.
    void begin(bool software);
    bool fast() const { return fast_; }
    // Why it is fast, as a clause; "": it is fine.
    const char* reason() const;

  private:
    bool software_ = false;  // and no frame was slow yet
    bool fast_ = false;
    int slow_ = 0, roomy_ = 0, patience_ = 120;  // frames
};

}  // namespace rivulet
