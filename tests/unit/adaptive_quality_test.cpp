// Quality drops before the frame rate does, returns when there is spare time, and does not oscillate.
#include <gtest/gtest.h>

#include "fluid/session/adaptive_quality.h"

namespace rivulet::adaptive_quality_test {
namespace {

void frames(AdaptiveQuality& quality, int count, double ms) {
    for (int k = 0; k < count; ++k) quality.frame(ms);
}

TEST(AdaptiveQuality, SlowFramesMakeItFastAndOneDoesNot) {
    AdaptiveQuality quality;
    EXPECT_FALSE(quality.fast());
    for (int k = 0; k < 20; ++k) {
        quality.frame(100);  // a hitch
        frames(quality, 10, 5);
    }
    EXPECT_FALSE(quality.fast());
    EXPECT_STREQ(quality.reason(), "");
    frames(quality, 30, 13);
    EXPECT_TRUE(quality.fast());
    EXPECT_STREQ(quality.reason(), "drawing over 12 ms");
}

TEST(AdaptiveQuality, SpareTimeMakesItFineAgain) {
    AdaptiveQuality quality;
    quality.begin(true);
    EXPECT_TRUE(quality.fast());
    frames(quality, 1000, 6);  // in time, but the fine picture would not be
    EXPECT_TRUE(quality.fast());
    frames(quality, 1000, 1);
    EXPECT_FALSE(quality.fast());
}

// A machine on which fast has room and fine has none: the longer it lasts, the rarer the changes.
TEST(AdaptiveQuality, ItDoesNotOscillate) {
    AdaptiveQuality quality;
    int changes[4] = {};
    for (int part = 0; part < 4; ++part)
        for (int k = 0; k < 3600; ++k) {
            const bool before = quality.fast();
            quality.frame(before ? 2 : 20);
            changes[part] += quality.fast() != before ? 1 : 0;
        }
    EXPECT_LE(changes[0], 12);
    EXPECT_LE(changes[3], 2);
}

}  // namespace
}  // namespace rivulet::adaptive_quality_test
