// A run recorded as it is drawn, and shown again from the file, without simulating.
//
//     Result<RecordingWriter> file = RecordingWriter::open("run.rrec", aboutOf(session->scene()));
//     session->step(...);  file->add(frameOf(*session));  ...  file->close();
//
//     Result<Replay> replay = Replay::open("run.rrec", session->scene(), log);
//     session->replay(std::move(*replay));  session->step(...);  viewOf(upload, *session)
//
// Recorded are particles with their ellipsoids and colours, foam, and where solids are; not skins (tears), which such a scene is refused
// for. Camera, light, look and background are the scene file's, and may be others than in the run.
#pragma once

#include <string>

#include "engine/core/log.h"
#include "fluid/io/recording.h"
#include "fluid/scene/scene_file.h"

namespace rivulet {

class FluidUpload;
class Session;
struct FluidView;

// What a recording must have in common with the scene that it is shown in: its name, its colliders and bodies.
std::string aboutOf(const SceneFile& scene);
// What the session shows now. Waits for the device.
RecordedFrame frameOf(const Session& session);
// What the session shows, its world or a recorded frame, as buffers. Error: as FluidUpload::view.
Result<FluidView> viewOf(FluidUpload& upload, const Session& session);

// The frames of a file, one after the other.
class Replay {
  public:
    // The first frame is shown then. Error: as RecordingReader; badInput: of another scene. What was cut off is said to `log`.
    static Result<Replay> open(const std::string& path, const SceneFile& scene, const Log& log);

    const RecordedFrame& shown() const { return frame_; }
    size_t at() const { return at_; }  // which one is shown
    size_t frames() const { return reader_.frames(); }
    void seek(size_t k) { next_ = k; }  // what the next next() shows
    // The last frame stays. Error: as RecordingReader::read; shown() is then as it was.
    Status next();
    const Status& status() const { return status_; }  // of the last next()
    std::string sentence() const;                     // for the person: which frame of which file

  private:
    Replay(RecordingReader reader, std::string path) : reader_(std::move(reader)), path_(std::move(path)) {}
    RecordingReader reader_;
    std::string path_;
    RecordedFrame frame_;
    size_t at_ = 0, next_ = 0;
    Status status_ = ok();
};

}  // namespace rivulet
