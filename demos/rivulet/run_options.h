// The options of `rivulet run`, and its two main loops: headless and in a window.
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
    std::string cooperate = "off";  // a name in plans(), or auto
    bool render = true;
    bool headless = false;  // no window
    bool explain = false;
    std::optional<int> frames;       // number of frames; empty: the loop's own default
    std::optional<int> first;        // the first frame, if only a piece of a recording is drawn, which ends before `frames`
    int width = 1280, height = 720;  // pixels
    bool sized = false;              // --size was given
    std::string out = "out";         // output folder
    std::string video;               // file; empty: out/NAME.mp4
    std::string stats;               // file; empty: out/stats.json, or none in the window
    std::set<int> stills;            // frame numbers to draw; empty: a video of all frames, and six images
    bool images = false;             // draw an image of each frame, and no video
    std::string save, resume;        // state files; empty: none
    std::string record, replay;      // recording files; empty: none
    std::string trace;               // timeline file; empty: none
    Log log;
};

// The files of a headless run.
struct OutputNames {
    std::string stats, video;
    std::string picturePrefix;  // "out/dam_break", of out/dam_break_0000.png
};
OutputNames namesOf(const RunOptions& options);

// What the arguments of `rivulet run` request, with the scene read and all values checked; nothing is opened or written. Empty: --help was
// printed. Error (badInput): an argument, the scene, or values that contradict each other.
Result<std::optional<RunOptions>> readRun(const std::vector<std::string>& arguments);

// Each returns an ExitCode.
int runHeadless(const RunOptions& options);
int runWindow(const RunOptions& options);

inline constexpr int kMostFrames = 60'000'000;
// The number of frames that show `seconds` of simulated time. Error (badInput): more than kMostFrames; `place` names the option or key
// that the number comes from.
Result<int> framesOf(double seconds, const SceneFile& scene, std::string_view place);

// Reads and writes a state file. Error: badInput if the file does not fit, failed if it cannot be written.
Status resumeFrom(const std::string& path, Session& session);
Status saveTo(const std::string& path, Session& session);

// If options.replay names a recording, the session shows it instead of simulating. Error: as Replay::open and Session::replay.
Status replayOf(const RunOptions& options, Session& session);
// Opens the file that options.record names; empty if it names none. Error (failed): not writable.
Result<std::optional<RecordingWriter>> recordingOf(const RunOptions& options, const Session& session);

// The scene's name as a file name: ASCII letters, digits, '-' and '_' are kept, other characters become '_'; at most 100 characters.
std::string fileNameOf(const std::string& sceneName);

}  // namespace rivulet
