// ScreenCapture: pictures and videos of what is shown, written into the folder that the program runs in and named after the scene.
#pragma once

#include <future>
#include <optional>
#include <string>

#include "engine/app/capture.h"
#include "engine/core/log.h"
#include "engine/core/math.h"
#include "engine/core/result.h"

namespace rivulet {

class SceneRenderer;

// A scene's name as the beginning of a file's.
std::string fileName(std::string sceneName);

// A path that is free: the scene's name, a number, `kind` as its ending. Error (failed): the folder is not writable.
Result<std::string> freePath(const std::string& scene, const char* kind);

class ScreenCapture {
  public:
    bool filming() const { return video_.has_value(); }
    // Begins or ends a video; the log reports its path. Error (failed): no ffmpeg, or the file cannot be written.
    Status toggleVideo(const SceneRenderer& renderer, const std::string& scene, const Log& log);
    void stepped() { stepShown_ = true; }  // the picture that is drawn next goes into the video
    // Adds the picture that was drawn last to the video, one a step. Another size of the picture ends the video. After an Error (failed:
    // disk full, ffmpeg ended) there is no video any more.
    Status film(const SceneRenderer& renderer, const Log& log);
    // Writes the picture that was drawn last, on another thread. Error (failed): the folder is not writable; the one before failed.
    Status takePicture(const SceneRenderer& renderer, const std::string& scene, const Log& log);
    Status endVideo(const Log& log);  // where there is one

  private:
    std::optional<VideoWriter> video_;
    ivec2 videoSize_{0};
    std::string videoPath_;
    uint64_t filmed_ = 0;          // pictures
    bool stepShown_ = false;       // a step was made that the video does not show yet
    std::future<Status> written_;  // the picture taken last
};

}  // namespace rivulet
