// What `rivulet run` was asked for, and the two loops that carry it out.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/log.h"
#include "fluid/scene/scene_file.h"
#include "fluid/session/session.h"

namespace rivulet {

struct RunOptions {
    SceneFile scene;
    std::string backend;            // auto | cpu | gl | cl
    std::string device;             // of cl, as ClOptions::device
    std::string cooperate = "off";  // a row of plans(), or auto
    bool render = true;
    bool explain = false;
    std::optional<int> frames;       // how many; nothing: the loop's own default
    int width = 1280, height = 720;  // pixels
    bool sized = false;              // they were asked for
    std::string out = "out";         // folder of what is written
    std::string video;               // file; empty: out/NAME.mp4
    std::string stats;               // file; empty: out/stats.json, or none in the window
    std::set<int> stills;            // frames; empty: a video of all, and some pictures
    std::string save, resume;        // files of a state; empty: none
    std::string record, replay;      // files of a recording; empty: none
    std::string trace;               // file of a timeline; empty: none
    Log log;
};

// Each returns an ExitCode.
int runHeadless(const RunOptions& options);
int runWindow(const RunOptions& options);

inline constexpr int kMostFrames = 60'000'000;
// How many frames show `seconds`, simulated, of a scene. Error (badInput): more than kMostFrames; `place`: who asked for them.
Result<int> framesOf(double seconds, const SceneFile& scene, std::string_view place);

// A state from and to a file. Error: what is wrong with it, or why it cannot be written.
Status resumeFrom(const std::string& path, Session& session);
Status saveTo(const std::string& path, Session& session);

// Shows the recording of options.replay, if that names one, instead of simulating. Error: as Replay::open and Session::replay.
Status replayOf(const RunOptions& options, Session& session);
// The file of options.record, if that names one. Error (failed): not writable.
Result<std::optional<RecordingWriter>> recordingOf(const RunOptions& options, const Session& session);

// The scene's name as a file's: letters, digits, '-' and '_' stay, all else becomes '_'.
std::string fileNameOf(const std::string& sceneName);

}  // namespace rivulet
