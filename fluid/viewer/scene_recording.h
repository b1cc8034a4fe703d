// SceneRecording: records the run that is shown into a file beside the program, as --record does, and scrubs through it.
#pragma once

#include <optional>
#include <string>

#include "engine/core/log.h"
#include "fluid/session/replay.h"
#include "fluid/session/session.h"

namespace rivulet {

class SceneRecording {
  public:
    bool recording() const { return writer_.has_value(); }
    const std::string& path() const { return path_; }  // of the last recording of this session; "": there is none
    // Begins or ends a recording; the log reports its path. Error (badInput): the scene has skins, or a recording is shown. Error (failed):
    // the file is not writable.
    Status toggle(const Session& session, const Log& log);
    // Ends the recording, if there is one: the run does not go on as before.
    Status end(const Log& log);
    // The session's frame, after a step. After an Error (failed: disk full) nothing is recorded any more.
    Status stepped(const Session& session);
    void forget() { path_.clear(); }  // another session begins

    enum class Ask { none, stop, replay, simulate, scrub };
    struct Asked {
        Ask ask = Ask::none;
        size_t frame = 0;  // to scrub to
    };
    // The timeline over the picture, from `left` to `right`, px; nothing where nothing was recorded or is shown.
    Asked drawTimeline(const Session& session, float left, float right);

  private:
    std::optional<RecordingWriter> writer_;
    std::string path_;
    size_t frames_ = 0;
    double from_ = 0, to_ = 0;  // s simulated
};

}  // namespace rivulet
