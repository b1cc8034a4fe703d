#include "fluid/session/adaptive_quality.h"

#include <algorithm>

namespace rivulet {

namespace {

constexpr int kSlowFrames = 12, kMostPatience = 7200;  // frames
constexpr double kRoom = 0.25;                         // of kMost

}  // namespace

void AdaptiveQuality::begin(bool software) {
    *this = {};
    fast_ = software;
}

void AdaptiveQuality::frame(double ms) {
    if (!fast_) {
        slow_ = ms > kMost ? slow_ + 1 : 0;
        if (slow_ < kSlowFrames) return;
        fast_ = true;
        roomy_ = 0;
        return;
    }
    roomy_ = ms < kRoom * kMost ? roomy_ + 1 : 0;
    if (roomy_ < patience_) return;
    fast_ = false;
    slow_ = 0;
    patience_ = std::min(2 * patience_, kMostPatience);
}

}  // namespace rivulet
