// InputEvents: what the person did since the last frame. WindowGlfw fills it; tests fill it themselves.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "engine/core/math.h"

namespace rivulet {

enum class MouseButton { left, right, middle };

struct InputEvents {
    vec2 mouse{0.0F};                  // window coordinates, from the top left corner
    vec2 mouseDelta{0.0F};             // since the last frame
    bool buttonDown[3] = {};           // by MouseButton: held now
    bool buttonPressed[3] = {};        // went down since the last frame
    bool buttonReleased[3] = {};       // went up
    vec2 wheel{0.0F};                  // steps; y > 0 is away from the person
    std::vector<int> keysPressed;      // GLFW_KEY_*: printable keys by US layout, letters as 'A'; repeats are not in it
    std::vector<int> keysDown;         // held now
    std::string text;                  // UTF-8 typed
    ivec2 size{0};                     // window coordinates; 0 when minimised
    ivec2 framebuffer{0};              // pixels; 0 when minimised
    bool closed = false;               // the person asked to close the window
    std::vector<std::string> dropped;  // paths of files

    bool down(MouseButton b) const { return buttonDown[static_cast<int>(b)]; }
    bool pressed(MouseButton b) const { return buttonPressed[static_cast<int>(b)]; }
    bool pressed(int key) const { return std::find(keysPressed.begin(), keysPressed.end(), key) != keysPressed.end(); }
    bool down(int key) const { return std::find(keysDown.begin(), keysDown.end(), key) != keysDown.end(); }
};

}  // namespace rivulet
