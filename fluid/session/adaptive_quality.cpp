#include "fluid/session/adaptive_quality.h"

#include <algorithm>

namespace rivulet {

namespace {

constexpr int kSlowFrames = 12, kMostPatience = 7200;  // frames
constexpr double kRoom = 0.25;                         // of kMost

}  // namespace

void AdaptiveQuality::begin(bool software) {
    *this = {};
    fast_ = software_ = software;
}

void AdaptiveQuality::frame(double ms) {
    if (!fast_) {
        slow_ = ms > kMost ? slow_ + 1 : 0;
        if (slow_ < kSlowFrames) return;
        fast_ = true;
        software_ = false;
        roomy_ = 0;
        return;
    }
    roomy_ = ms < kRoom * kMost ? roomy_ + 1 : 0;
    if (roomy_ < patience_) return;
    fast_ = software_ = false;
    slow_ = 0;
    patience_ = std::min(2 * patience_, kMostPatience);
}

const char* AdaptiveQuality::reason() const {
    static_assert(kMost == 12, "the sentence names it");
    return !fast_ ? "" : software_ ? "drawn without a GPU" : "drawing over 12 ms";
}

}  // namespace rivulet
