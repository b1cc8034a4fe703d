// Pictures to files: PNG, and video through ffmpeg. A file appears whole under its name, or not at all.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "engine/core/result.h"

namespace rivulet {

// `rgba`: 4 * width * height bytes, sRGB, top row first; alpha is dropped. Error (failed): not writable, disk full.
Status writePng(const std::string& path, std::span<const uint8_t> rgba, int width, int height);

// Makes the folder and its parents. Error (failed): not writable, or a file is in the way.
Status makeFolder(const std::string& path);

// H.264 in the container that the name's ending selects. ffmpeg runs in a process group of its own, so Ctrl-C at the terminal does not
// reach it, and writes to the temporary file of a NewFile, which takes the target's name in close(). A target that is
// no ordinary file (/dev/null) is written directly. Dropped without close(): ffmpeg is ended and nothing is left.
class VideoWriter {
  public:
    // Error (failed): ffmpeg is not installed, the folder is not writable.
    static Result<VideoWriter> open(const std::string& path, int width, int height, int framesPerSecond);
    VideoWriter(VideoWriter&&) noexcept;
    VideoWriter& operator=(VideoWriter&&) noexcept;
    ~VideoWriter();

    // One frame as for writePng, of the size given to open(). Error (failed): disk full, ffmpeg ended, or was stopped (SIGSTOP) for 30 s;
    // later calls fail too.
    Status add(std::span<const uint8_t> rgba);
    // Waits for ffmpeg and names the file. No frame was added: no file, no error.
    Status close();

  private:
    struct Impl;
    explicit VideoWriter(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace rivulet
