// However long a frame takes, nothing that a person did meanwhile is lost, and it happens where it was done.
#include "engine/app/input_queue.h"

#include <gtest/gtest.h>

namespace rivulet::input_queue_test {
namespace {

TEST(InputQueue, AClickWithinAFrameIsTwoFramesAndWhereThePointerWas) {
    InputQueue queue;
    InputEvents e;
    queue.move({10, 20});
    queue.button(MouseButton::left, true);
    queue.button(MouseButton::left, false);
    queue.move({90, 80});
    queue.take(e);
    EXPECT_TRUE(e.pressed(MouseButton::left) && e.down(MouseButton::left));
    EXPECT_EQ(e.mouse, vec2(10, 20));
    queue.take(e);
    EXPECT_TRUE(e.buttonReleased[0] && !e.down(MouseButton::left) && !e.pressed(MouseButton::left));
    EXPECT_EQ(e.mouse, vec2(10, 20));
    queue.take(e);
    EXPECT_EQ(e.mouse, vec2(90, 80));
    EXPECT_FALSE(e.buttonReleased[0]);
    EXPECT_TRUE(queue.empty());
}

TEST(InputQueue, ADragWithinAFrameMovesWhileTheButtonIsHeld) {
    InputQueue queue;
    InputEvents e;
    e.mouse = {10, 20};
    queue.button(MouseButton::left, true);
    for (int k = 1; k <= 5; ++k) queue.move({10 + 10 * k, 20});
    queue.button(MouseButton::left, false);
    vec2 dragged(0.0F);
    for (int frame = 0; frame < 10 && !queue.empty(); ++frame) {
        queue.take(e);
        if (e.down(MouseButton::left)) dragged += e.mouseDelta;
    }
    EXPECT_EQ(dragged, vec2(50, 0));
    EXPECT_FALSE(e.down(MouseButton::left));
}

// On a German keyboard Z is where Y is on a US one, and plus has a key of its own.
TEST(InputQueue, AKeyIsNamedByItsPrintedLetter) {
    EXPECT_EQ(keyOf('Y', "z"), 'Z');
    EXPECT_EQ(keyOf('Z', "y"), 'Y');
    EXPECT_EQ(keyOf(']', "+"), '+');
    EXPECT_EQ(keyOf(334, "+"), '+') << "the number pad's";
    EXPECT_EQ(keyOf('1', "1"), '1');
    EXPECT_EQ(keyOf('A', "\xD1\x84"), 'A') << "Cyrillic";
    EXPECT_EQ(keyOf('2', "\xC3\xA9"), '2') << "French digits are with shift";
    EXPECT_EQ(keyOf(' ', " "), ' ');
    EXPECT_EQ(keyOf(key::kEscape, nullptr), key::kEscape);
}

TEST(InputQueue, TwoClicksAreTwo) {
    InputQueue queue;
    InputEvents e;
    for (const bool down : {true, false, true, false}) queue.button(MouseButton::right, down);
    int pressed = 0, released = 0;
    while (!queue.empty()) {
        queue.take(e);
        pressed += e.pressed(MouseButton::right) ? 1 : 0;
        released += e.buttonReleased[1] ? 1 : 0;
    }
    EXPECT_EQ(pressed, 2);
    EXPECT_EQ(released, 2);
}

TEST(InputQueue, AKeyWithControlKeepsControlAndLaterKeysComeLater) {
    InputQueue queue;
    InputEvents e;
    queue.key(key::kLeftControl, true);
    queue.key('F', true);
    queue.key('F', false);
    queue.key(key::kLeftControl, false);
    queue.key('T', true);
    queue.type("t");
    queue.key('T', false);
    queue.take(e);
    EXPECT_TRUE(e.pressed('F') && e.down(key::kLeftControl));
    EXPECT_EQ(e.text, "");
    queue.take(e);
    EXPECT_FALSE(e.down(key::kLeftControl));
    EXPECT_TRUE(e.pressed('T'));
    EXPECT_EQ(e.text, "t");
    EXPECT_TRUE(queue.empty());
}

TEST(InputQueue, WordsTypedTheWheelAndDroppedFilesComeAtOnce) {
    InputQueue queue;
    InputEvents e;
    for (const char* letter : {"w", "a", "\xC3\xA4"}) {
        queue.key('W', true);
        queue.type(letter);
        queue.key('W', false);
    }
    queue.wheel({0, 1});
    queue.wheel({0, 2});
    queue.drop("a.obj");
    queue.drop("b.obj");
    queue.take(e);
    EXPECT_EQ(e.text, "wa\xC3\xA4");
    EXPECT_EQ(e.wheel, vec2(0, 3));
    EXPECT_EQ(e.dropped.size(), 2U);
    queue.take(e);
    EXPECT_TRUE(e.text.empty() && e.dropped.empty() && e.wheel == vec2(0.0F) && e.keysPressed.empty() && e.keysDown.empty());
}

// The field that a click opens takes the keyboard a frame later.
TEST(InputQueue, KeysAfterAClickBelongToALaterFrame) {
    InputQueue queue;
    InputEvents e;
    queue.button(MouseButton::left, true);
    queue.type("x");
    queue.take(e);
    EXPECT_EQ(e.text, "");
    queue.take(e);
    EXPECT_EQ(e.text, "x");
}

}  // namespace
}  // namespace rivulet::input_queue_test
