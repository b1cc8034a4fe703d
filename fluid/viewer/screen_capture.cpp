#include "fluid/viewer/screen_capture.h"

#include <fmt/format.h>

#include <filesystem>
#include <utility>

#include "engine/core/file.h"
#include "fluid/session/scene_renderer.h"
#include "fluid/session/session.h"

namespace rivulet {

Result<std::string> freePath(const std::string& scene, const char* kind) {
    std::error_code error;
    std::string path;
    for (int k = 1; path.empty() || std::filesystem::exists(path, error); ++k) path = fmt::format("{}_{:04}.{}", fileName(scene), k, kind);
    if (Status writable = checkWritable(path); !writable) return writable.error();
    return path;
}

std::string fileName(std::string sceneName) {
    for (char& c : sceneName)
        if (c == '/' || static_cast<unsigned char>(c) < ' ') c = '_';
    return sceneName.empty() || sceneName.front() == '.' ? "scene" + sceneName : sceneName;
}

Status ScreenCapture::toggleVideo(const SceneRenderer& renderer, const std::string& scene, const Log& log) {
    if (video_) return endVideo(log);
    videoSize_ = {renderer.width(), renderer.height()};
    if (videoSize_.x <= 0) return ok();
    Result<std::string> path = freePath(scene, "mp4");
    if (!path) return path.error();
    Result<VideoWriter> video = VideoWriter::open(*path, videoSize_.x, videoSize_.y, kFramesPerSecond);
    if (!video) return video.error();
    video_ = std::move(*video);
    videoPath_ = *path;
    filmed_ = 0;
    stepShown_ = false;
    log.notice("recording a video; press F9 to stop");
    return ok();
}

Status ScreenCapture::endVideo(const Log& log) {
    if (!video_) return ok();
    VideoWriter done = std::move(*video_);
    video_.reset();
    const Status closed = done.close();
    if (closed) log.notice(filmed_ > 0 ? "video saved: " + videoPath_ : "no step was made: no video was written");
    return closed;
}

Status ScreenCapture::film(const SceneRenderer& renderer, const Log& log) {
    if (!video_ || !std::exchange(stepShown_, false)) return ok();
    if (ivec2(renderer.width(), renderer.height()) != videoSize_) {
        log.notice("the window was resized: the video ends here");
        return endVideo(log);
    }
    ++filmed_;
    Status added = video_->add(renderer.pixels());
    if (!added) video_.reset();
    return added;
}

Status ScreenCapture::takePicture(const SceneRenderer& renderer, const std::string& scene, const Log& log) {
    if (renderer.width() <= 0) return ok();
    if (written_.valid())
        if (Status last = written_.get(); !last) return last;
    const Result<std::string> path = freePath(scene, "png");
    if (!path) return path.error();
    written_ = std::async(std::launch::async, [path = *path, pixels = renderer.pixels(), width = renderer.width(),
                                               height = renderer.height()] { return writePng(path, pixels, width, height); });
    log.notice("picture saved: " + *path);
    return ok();
}

}  // namespace rivulet
