// HotReload: reloads shaders and the scene's file when they change on disk. A file that does not compile or cannot be read changes nothing;
// its error is shown until the file is corrected.
#pragma once

#include <optional>
#include <string>

#include "engine/core/file_watch.h"
#include "fluid/session/scene_renderer.h"

namespace rivulet {

class HotReload {
  public:
    // `root`: of ShaderFiles; "": the shaders are embedded in the program, and none is watched.
    explicit HotReload(const std::string& root);

    // Watches the file of this scene from now on; a scene without a file is not watched.
    void follow(const SceneFile& scene);

    // Checks the files 5 times a second. The renderer and the device take changed shaders. A changed scene that can be read is returned
    // once. It keeps the person's edits of the scene that is `shown` (camera, values, added objects), except where the file changed them.
    std::optional<SceneFile> look(double seconds, const SceneFile& shown, SceneRenderer& renderer, Device& device);
    const SceneFile& before() const { return before_; }           // the file before the last change
    const SceneFile& opened() const { return opened_; }           // the file, without edits
    void refuse(const std::string& why) { sceneTrouble_ = why; }  // look()'s scene cannot be opened

    bool broken() const { return !shaderTrouble_.empty(); }  // the shaders in use are older than the files
    std::string message() const;                             // "": all files are in use
    void draw() const;                                       // over the picture, low in its middle

  private:
    void takeShaders(const std::vector<std::string>& written, SceneRenderer& renderer, Device& device);
    std::optional<SceneFile> takeScene(const SceneFile& shown);

    FileWatch watch_;
    std::string scene_;        // its file
    SceneFile read_, before_;  // the file when it was valid last, and before that
    SceneFile opened_;
    std::string shaderTrouble_, sceneTrouble_, done_;
    double waited_ = 0;   // s since the last check
    double doneFor_ = 0;  // s that done_ is still shown
};

}  // namespace rivulet
