// Recordings: a run is recorded as it is drawn, and shown again from the file without simulation.
//
//     Result<RecordingWriter> file = RecordingWriter::open("run.rrec", recordedText(*session));
//     session->step(...);  file->add(frameOf(*session));  ...  file->close();
//
//     Result<Replay> replay = Replay::open("run.rrec", session->scene(), log);
//     session->replay(std::move(*replay));  session->step(...);  viewOf(upload, *session)
//
// A recording holds particles with their ellipsoids and colours, foam, and the places of solids. A scene with skins is refused. Camera,
// light, look and background come from the scene file and may differ from those of the run.
#pragma once

#include <string>

#include "engine/core/log.h"
#include "fluid/io/recording.h"
#include "fluid/scene/scene_file.h"

namespace rivulet {

class FluidUpload;
class Session;
struct FluidView;

// The values in which a recording must agree with the scene: its name, its colliders and bodies, one a line.
std::string aboutOf(const SceneFile& scene);
// The text of a recording: aboutOf the session's scene, then the run.
std::string recordedText(const Session& session);
// The session's frame as shown now. Waits for the device.
RecordedFrame frameOf(const Session& session);
// The session's world or recorded frame, as buffers. Error: as FluidUpload::view.
Result<FluidView> viewOf(FluidUpload& upload, const Session& session);

// The frames of a file, in order.
class Replay {
  public:
    // shown() is the first frame. Error: as RecordingReader; (badInput) it is of another scene. A truncated file is logged.
    static Result<Replay> open(const std::string& path, const SceneFile& scene, const Log& log);

    const RecordedFrame& shown() const { return frame_; }
    size_t at() const { return at_; }  // the index of shown()
    size_t frames() const { return reader_.frames(); }
    void seek(size_t k) { next_ = k; }  // the index that next() reads
    // At the end shown() stays the last frame. Error: as RecordingReader::read; shown() is unchanged then.
    Status next();
    const Status& status() const { return status_; }  // of the last next()
    std::string sentence() const;                     // for display: the frame and the file

  private:
    Replay(RecordingReader reader, std::string path) : reader_(std::move(reader)), path_(std::move(path)) {}
    RecordingReader reader_;
    std::string path_;
    RecordedFrame frame_;
    size_t at_ = 0, next_ = 0;
    Status status_ = ok();
};

}  // namespace rivulet
