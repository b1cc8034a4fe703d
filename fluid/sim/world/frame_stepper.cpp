#include "fluid/sim/world/frame_stepper.h"

#include <algorithm>
#include <cmath>

namespace rivulet {

FrameStepper::Frame FrameStepper::begin(double seconds, double fixedStep, double budgetMs, bool whole) {
    budgetMs_ = budgetMs;
    if (budgetMs > 0) start_ = Clock::now();
    seconds_ = seconds;
    fixedStep_ = fixedStep;
    const double before = pending_;
    if (fixedStep > 0) {
        // The tolerance absorbs rounding: a frame as long as a fixed step is one step.
        const double steps = std::floor((before + seconds) / fixedStep + 1.0e-9);
        return {static_cast<int>(std::min(steps, 1.0e9)), fixedStep, before};
    }
    // A long frame has several pieces: speeds may grow in it, and each piece has a step limit from its own speeds.
    constexpr double kLongestPiece = 1.0 / 60;  // s
    const double pieces = whole ? 1 : std::clamp(std::ceil(seconds / kLongestPiece - 1.0e-6), 1.0, 1.0e9);
    return {static_cast<int>(pieces), (before + seconds) / pieces, before};
}

void FrameStepper::recordTime(double ms, int substeps) {
    if (!(ms >= 0)) return;  // NaN or negative: no measurement
    constexpr double kKept = 0.9;
    workMs_ = kKept * workMs_ + ms;
    workSubsteps_ = kKept * workSubsteps_ + substeps;
}

double FrameStepper::end(double stepped) {
    const double left = std::max(pending_ + seconds_ - stepped, 0.0);
    pending_ = 0;
    if (fixedStep_ > 0) {
        pending_ = left - fixedStep_ * std::floor(left / fixedStep_ + 1.0e-9);
        pending_ = std::max(pending_, 0.0);
    }
    return left - pending_;
}

}  // namespace rivulet
