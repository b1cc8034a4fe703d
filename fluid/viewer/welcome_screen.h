// WelcomeScreen: one screen that says what this is and what to try, for who opens the window for the first time.
#pragma once

#include <string>

#include "engine/app/input_events.h"

namespace rivulet {

// The file that says that somebody has seen it, $XDG_CONFIG_HOME/rivulet/seen, else ~/.config/rivulet/seen. "": there is no place for one.
std::string seenFile();

class WelcomeScreen {
  public:
    WelcomeScreen() = default;
    // Shown where no such file is; "": not at all.
    explicit WelcomeScreen(std::string seen);
    bool shown() const { return shown_; }
    // Over all else, until any key or click: then it is never shown again. Between UiLayer's begin and draw.
    void draw(const InputEvents& input);

  private:
    std::string seen_;
    bool shown_ = false;
    float tall_ = 320;  // as its words need it, as of the frame before
};

}  // namespace rivulet
