// The picture gives way before the frame rate does, comes back when there is room, and does not swing to and fro.
#include <gtest/gtest.h>

#include "fluid/session/adaptive_quality.h"

namespace rivulet {
namespace {

void frames(Haste& haste, int count, double ms) {
    for (int k = 0; k < count; ++k) haste.frame(ms);
}

TEST(Haste, SlowFramesMakeItFastAndOneDoesNot) {
    Haste haste;
    EXPECT_FALSE(haste.fast());
    for (int k = 0; k < 20; ++k) {
        haste.frame(100);  // a hitch
        frames(haste, 10, 5);
    }
    EXPECT_FALSE(haste.fast());
    frames(haste, 30, 13);
    EXPECT_TRUE(haste.fast());
}

TEST(Haste, RoomMakesItFineAgain) {
    Haste haste;
    haste.begin(true);
    EXPECT_TRUE(haste.fast());
    frames(haste, 1000, 6);  // in time, but the fine picture would not be
    EXPECT_TRUE(haste.fast());
    frames(haste, 1000, 1);
    EXPECT_FALSE(haste.fast());
}

// A machine on which fast has room and fine has none: the longer it lasts, the rarer the changes.
TEST(Haste, ItDoesNotSwing) {
    Haste haste;
    int changes[4] = {};
    for (int part = 0; part < 4; ++part)
        for (int k = 0; k < 3600; ++k) {
            const bool before = haste.fast();
            haste.frame(before ? 2 : 20);
            changes[part] += haste.fast() != before ? 1 : 0;
        }
    EXPECT_LE(changes[0], 12);
    EXPECT_LE(changes[3], 2);
}

}  // namespace
}  // namespace rivulet
