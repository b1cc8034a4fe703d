// WelcomeScreen: one screen with the controls and things to try, shown when the window is opened for the first time.
#pragma once

#include <string>

#include "engine/app/input_events.h"

namespace rivulet {

// The file that records that it was shown: $XDG_CONFIG_HOME/rivulet/seen, else ~/.config/rivulet/seen. "": neither variable is set.
std::string seenFile();

class WelcomeScreen {
  public:
    WelcomeScreen() = default;
    // Shown if the file `seen` does not exist; "": never shown.
    explicit WelcomeScreen(std::string seen);
    bool shown() const { return shown_; }
    // Drawn over everything until a key or click, which creates the file. Between UiLayer's begin and draw.
    void draw(const InputEvents& input);

  private:
    std::string seen_;
    bool shown_ = false;
    float tall_ = 320;  // px, the height of its text in the last frame
};

}  // namespace rivulet
