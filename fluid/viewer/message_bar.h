// MessageBar: messages low in the middle of the picture, for when the panels are hidden.
#pragma once

#include <string>

namespace rivulet {

class MessageBar {
  public:
    // Shows `text`, each new text for 12 s. `hidden`: something else is shown in its place. `seconds` since the last frame.
    void draw(std::string text, double seconds, bool hidden);

  private:
    std::string shown_;
    double shownFor_ = 0;  // s
};

}  // namespace rivulet
