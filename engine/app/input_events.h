// InputEvents: what the person did since the last frame. WindowGlfw fills it; tests fill it themselves.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "engine/core/math.h"

namespace rivulet {

enum class MouseButton { left, right, middle };

// Keys that print nothing, by GLFW's numbers; the others are the character they print without shift, in capitals: 'R', ' ', '.'; where
// that is none of ASCII's, as on a Greek keyboard: of a US keyboard.
namespace key {
inline constexpr int kEscape = 256, kEnter = 257, kTab = 258, kBackspace = 259, kInsert = 260, kDelete = 261;
inline constexpr int kRight = 262, kLeft = 263, kDown = 264, kUp = 265;
inline constexpr int kPageUp = 266, kPageDown = 267, kHome = 268, kEnd = 269;
inline constexpr int kF1 = 290;  // kF1 + n - 1 is Fn
inline constexpr int kLeftShift = 340, kLeftControl = 341, kLeftAlt = 342, kRightShift = 344, kRightControl = 345, kRightAlt = 346;
}  // namespace key

struct InputEvents {
    vec2 mouse{0.0F};              // window coordinates, from the top left corner
    vec2 mouseDelta{0.0F};         // since the last frame
    bool buttonDown[3] = {};       // by MouseButton: held now
    bool buttonPressed[3] = {};    // went down since the last frame
    bool buttonReleased[3] = {};   // went up
    vec2 wheel{0.0F};              // steps; y > 0 is away from the person
    std::vector<int> keysPressed;  // went down since the last frame; repeats are not in it
    std::vector<int> keysDown;     // held now
    std::string text;              // UTF-8 typed
    ivec2 size{0};                 // window coordinates; 0 when minimised
    ivec2 framebuffer{0};          // pixels; 0 when minimised
    float scale = 1.0F;            // how many window coordinates are as wide as a pixel of an ordinary screen, for panels and their text
    bool closed = false;           // the person asked to close the window
    std::vector<std::string> dropped;  // paths of files

    bool down(MouseButton b) const { return buttonDown[static_cast<int>(b)]; }
    bool pressed(MouseButton b) const { return buttonPressed[static_cast<int>(b)]; }
    bool pressed(int key) const { return std::find(keysPressed.begin(), keysPressed.end(), key) != keysPressed.end(); }
    bool down(int key) const { return std::find(keysDown.begin(), keysDown.end(), key) != keysDown.end(); }
};

}  // namespace rivulet
