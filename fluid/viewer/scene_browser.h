// SceneBrowser: the installed scenes as cards with a picture and a description, and a field for the path of any scene file.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/gpu/texture.h"
#include "fluid/scene/scene_file.h"
#include "fluid/viewer/scene_sketch.h"

namespace rivulet {

class SceneBrowser {
  public:
    void show(bool yes);  // when shown, the list of scenes is read again
    bool shown() const { return shown_; }
    // Call it while shown. Returns the path of a chosen scene, for loadScene; the caller then calls show(false) or refuse().
    std::optional<std::string> draw();
    void refuse(const std::string& why);

    const std::vector<SceneListing>& scenes() const { return scenes_; }  // in the order of the cards

  private:
    bool card(size_t index, float width);
    // From pictures/ in the scene's folder; null: there is none. Reads at most one file per frame.
    const gpu::Texture* pictureOf(const std::string& scene);

    bool shown_ = false, refocus_ = false;
    std::vector<SceneListing> scenes_;
    std::map<std::string, gpu::Texture> pictures_;  // by the scene's path; empty: it has none
    std::map<std::string, SceneSketch> sketches_;   // instead, of those that were looked for
    bool readOne_ = false;                          // in this frame
    std::string wanted_, path_, trouble_;
};

}  // namespace rivulet
