// SaveDialog: lets the user choose a file name, and saves the scene.
#pragma once

#include <optional>
#include <string>

#include "fluid/scene/scene_file.h"

namespace rivulet {

// A path as a shell reads it: ~ is the person's own folder.
std::string fullPath(const std::string& typed);

class SaveDialog {
  public:
    void show(bool yes) { shown_ = yes; }
    bool shown() const { return shown_; }
    void forgetPath() { path_.clear(); }  // the next scene gets a name of its own
    // Where it is shown, over the middle of the picture. The path that the scene was written to, once; why it cannot be is shown.
    std::optional<std::string> draw(const SceneFile& scene);

  private:
    std::string path_, trouble_;  // as typed; why it was refused
    bool shown_ = false;
    bool refocus_ = false;  // what was refused is typed on
};

}  // namespace rivulet
