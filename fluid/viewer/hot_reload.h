// HotReload: shaders and the scene's file are read again when they are written. What does not compile, or cannot be read, changes nothing,
// and is shown until it is mended.
#pragma once

#include <optional>
#include <string>

#include "engine/core/file_watch.h"
#include "fluid/session/scene_renderer.h"

namespace rivulet {

class HotReload {
  public:
    // `root`: as ShaderFiles has it; "": the shaders are inside the program, and none is watched.
    explicit HotReload(const std::string& root);

    // From now on this is the scene whose file is watched, as it is now; one that came from no file is not.
    void follow(const SceneFile& scene);

    // Looks some times a second. Shaders that were written are taken by the renderer and the device. A scene that was written and can be
    // read is returned, once, with what a person has made of the one that is `shown`: the camera, values and things that were added, all
    // unless it is they that were written.
    std::optional<SceneFile> look(double seconds, const SceneFile& shown, SceneRenderer& renderer, Device& device);
    const SceneFile& before() const { return before_; }           // as the file was before that
    const SceneFile& opened() const { return opened_; }           // as it is, without what a person made of it
    void refuse(const std::string& why) { sceneTrouble_ = why; }  // what look() returned cannot be shown

    bool broken() const { return !shaderTrouble_.empty(); }  // what is drawn with is not what the files say
    std::string message() const;                             // "": all is as the files say
    void draw() const;                                       // over the picture, low in its middle

  private:
    void takeShaders(const std::vector<std::string>& written, SceneRenderer& renderer, Device& device);
    std::optional<SceneFile> takeScene(const SceneFile& shown);

    FileWatch watch_;
    std::string scene_;        // its file
    SceneFile read_, before_;  // as the file was when it could be read last, and before that
    SceneFile opened_;
    std::string shaderTrouble_, sceneTrouble_, done_;
    double waited_ = 0;   // s since it looked
    double doneFor_ = 0;  // s that done_ is still shown
};

}  // namespace rivulet
