// How what a Viewer shows comes into files: pictures and videos, named after the scene.
#include <fmt/format.h>

#include <filesystem>
#include <utility>

#include "fluid/viewer/viewer.h"

namespace rivulet {

std::string fileName(std::string sceneName) {
    for (char& c : sceneName)
        if (c == '/' || static_cast<unsigned char>(c) < ' ') c = '_';
    return sceneName.empty() || sceneName.front() == '.' ? "scene" + sceneName : sceneName;
}

Status Viewer::toggleVideo() {
    if (video_) {
        VideoWriter done = std::move(*video_);
        video_.reset();
        const Status closed = done.close();
        if (closed) log_.notice(filmed_ > 0 ? "the video is in " + videoPath_ : "nothing moved: no video was written");
        return closed;
    }
    videoSize_ = {renderer_->width(), renderer_->height()};
    if (videoSize_.x <= 0) return ok();
    Result<std::string> path = freePath("mp4");
    if (!path) return path.error();
    Result<VideoWriter> video = VideoWriter::open(*path, videoSize_.x, videoSize_.y, kFramesPerSecond);
    if (!video) return video.error();
    video_ = std::move(*video);
    videoPath_ = *path;
    filmed_ = 0;
    stepShown_ = false;
    log_.notice("a video is made, till F9 again");
    return ok();
}

// As fast as the water: a picture a step, however long that took.
Status Viewer::film() {
    if (!video_ || !std::exchange(stepShown_, false)) return ok();
    if (ivec2(renderer_->width(), renderer_->height()) == videoSize_) {
        ++filmed_;
        return video_->add(renderer_->pixels());
    }
    log_.notice("the window has another size: the video ends here");
    return toggleVideo();
}

// Beside where the program runs, with the scene's name and the first number that is free. Error (failed): it cannot be written there.
Result<std::string> Viewer::freePath(const char* kind) const {
    std::error_code error;
    std::string path;
    for (int k = 1; path.empty() || std::filesystem::exists(path, error); ++k)
        path = fmt::format("{}_{:04}.{}", fileName(draft_.name), k, kind);
    if (Status writable = checkWritable(path); !writable) return writable.error();
    return path;
}

Status Viewer::takePicture() {
    if (renderer_->width() <= 0) return ok();
    if (written_.valid())
        if (Status last = written_.get(); !last) return last;
    const Result<std::string> path = freePath("png");
    if (!path) return path.error();
    written_ = std::async(std::launch::async, [path = *path, pixels = renderer_->pixels(), width = renderer_->width(),
                                               height = renderer_->height()] { return writePng(path, pixels, width, height); });
    log_.notice("a picture is in " + *path);
    return ok();
}

Viewer::~Viewer() {
    if (!video_) return;
    if (Status closed = video_->close(); !closed) log_.notice(closed.error().message);
}

}  // namespace rivulet
