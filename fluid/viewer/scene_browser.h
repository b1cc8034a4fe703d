// SceneBrowser: the scenes that are there, as cards with a picture and what they show; or any other scene file.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/gpu/texture.h"
#include "fluid/scene/scene_file.h"

namespace rivulet {

class SceneBrowser {
  public:
    void show(bool yes);  // and looks anew for scenes
    bool shown() const { return shown_; }
    // Where it is shown, over the middle of the picture. The path of the scene that was chosen, for loadScene: show(false), or refuse().
    std::optional<std::string> draw();
    void refuse(std::string why) { trouble_ = std::move(why); }

  private:
    bool card(size_t index, float width);
    // Beside the scene's folder, in pictures/ under its file's name; null: there is none. Reads one a frame at most.
    const gpu::Texture* pictureOf(const std::string& scene);

    bool shown_ = false, refocus_ = false;
    std::vector<SceneListing> scenes_;
    std::map<std::string, gpu::Texture> pictures_;  // by the scene's path; empty: it has none
    bool readOne_ = false;                          // in this frame
    std::string wanted_, path_, trouble_;
};

}  // namespace rivulet
