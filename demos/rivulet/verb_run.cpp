#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <cstdlib>

#include "demos/rivulet/cli.h"
#include "demos/rivulet/run_options.h"
#include "fluid/render/backend.h"
#include "fluid/session/cooperation.h"
#include "fluid/session/session.h"

namespace rivulet {

namespace {

bool hasDisplay() {
    auto given = [](const char* variable) {
        const char* value = std::getenv(variable);
        return value != nullptr && *value != '\0';
    };
    return given("DISPLAY") || given("WAYLAND_DISPLAY");
}

// The frame that shows the scene at a second written as `text`.
Result<int> frameAt(const std::string& text, const SceneFile& scene) {
    double at = -1;
    const auto [end, wrong] = std::from_chars(text.data(), text.data() + text.size(), at);
    if (wrong != std::errc() || end != text.data() + text.size() || !(at >= 0))
        return badInput(fmt::format("--still {}: give a time in seconds, 0 or more", text));
    return framesOf(at, scene, fmt::format("--still {}", text));
}

// A replay has no water of its own: what asks for figures or for a state of it makes no sense.
Status checkReplay(const RunOptions& options, bool noRender) {
    for (const auto& [name, given] : {std::pair("--record", !options.record.empty()), std::pair("--save", !options.save.empty()),
                                      std::pair("--resume", !options.resume.empty()), std::pair("--stats", !options.stats.empty()),
                                      std::pair("--explain", options.explain), std::pair("--no-render", noRender),
                                      std::pair("--cooperate", options.cooperate != "off")})
        if (given)
            return badInput(fmt::format("--replay shows a run that has been simulated before, so {} makes no sense: leave it out", name));
    return ok();
}

}  // namespace

std::string fileNameOf(const std::string& sceneName) {
    std::string name;
    for (char c : sceneName) {
        bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_';
        name += plain ? c : '_';
    }
    constexpr size_t kLongest = 100;
    return name.empty() ? "scene" : name.substr(0, kLongest);
}

Result<int> framesOf(double seconds, const SceneFile& scene, std::string_view place) {
    const double frames = std::round(seconds / frameSeconds(scene));
    if (frames <= kMostFrames) return static_cast<int>(frames);
    return badInput(
        fmt::format("{}: {:g} s at timeScale {:g} are {:g} frames, and there may be {}: ask for less, or for a larger timeScale", place,
                    seconds, scene.timeScale, frames, kMostFrames));
}

Status resumeFrom(const std::string& path, Session& session) {
    Result<WorldState> state = readState(path);
    if (!state) return state.error();
    Status done = session.restore(*state);
    if (!done) return Error{fmt::format("{}: {}", path, done.error().message), done.error().fault};
    return ok();
}

Status saveTo(const std::string& path, Session& session) {
    WorldState state;
    session.save(state);
    const Device& device = session.world().device();
    if (const DeviceHealth health = device.health(); health.state == DeviceHealth::lost)
        return failed(fmt::format("{} {}: what it holds means nothing, and {} is not written", device.info().name, health.why, path));
    Result<size_t> written = writeState(path, state);
    if (!written) return written.error();
    return ok();
}

Status replayOf(const RunOptions& options, Session& session) {
    if (options.replay.empty()) return ok();
    Result<Replay> replay = Replay::open(options.replay, session.scene(), options.log);
    if (!replay) return replay.error();
    if (Status done = session.replay(std::move(*replay)); !done)
        return Error{fmt::format("{}: {}", options.replay, done.error().message), done.error().fault};
    return ok();
}

Result<std::optional<RecordingWriter>> recordingOf(const RunOptions& options, const Session& session) {
    if (options.record.empty()) return std::optional<RecordingWriter>();
    Result<RecordingWriter> file = RecordingWriter::open(options.record, aboutOf(session.scene()));
    if (!file) return file.error();
    return std::optional(std::move(*file));
}

int runVerb(const Arguments& arguments) {
    ArgumentReader reader(
        "run", "Runs a scene: in a window where there is a display, else (or with --headless) to a video, pictures and figures.");
    std::string scene, size;
    RunOptions options;
    std::vector<std::string> assignments;
    std::string preset;
    std::vector<std::string> stills;
    bool headless = false, noRender = false;
    std::optional<double> seconds;
    reader.positional("SCENE.json", "the scene", scene, true);
    reader.option("--backend", "NAME", "what simulates: auto, cpu, gl or cl", options.backend);
    reader.option("--device", "TEXT", "which OpenCL device: a part of its name, or its number in 'list devices'", options.device);
    reader.flag("--headless", "no window: write a video, pictures and figures", headless);
    reader.flag("--no-render", "no pictures at all: simulate and write figures", noRender);
    reader.option("--frames", "N", "how many frames, 60 a second that is shown", options.frames, 0, kMostFrames);
    reader.option("--seconds", "S", "how long, simulated; headless default: the scene's duration", seconds, 0,
                  static_cast<double>(kMostFrames) / kFramesPerSecond);
    reader.exclude("--seconds", "--frames");
    reader.option("--size", "WxH", "of the picture, in pixels; 1280x720 if not said", size);
    reader.option("--out", "DIR", "folder that the video, pictures and figures go to", options.out);
    reader.option("--video", "FILE.mp4", "the video's file, instead of DIR/NAME.mp4", options.video);
    reader.option("--still", "S", "draw only the frame at this second, and no video; as often as you like", stills);
    reader.option("--stats", "FILE.json", "the figures' file, instead of DIR/stats.json", options.stats);
    reader.option("--cooperate", "PLAN", "who simulates while who draws: off, thesis, behind or auto, which tries them", options.cooperate);
    reader.option("--trace", "FILE.json", "who worked on what and when, for chrome://tracing or Perfetto", options.trace);
    reader.option("--save", "FILE", "the whole state at the run's end, for --resume", options.save);
    reader.option("--resume", "FILE", "go on from a state that --save wrote, of the same scene", options.resume);
    reader.option("--record", "FILE.rrec", "what each frame shows, bit for bit, for --replay; not with skins", options.record);
    reader.option("--replay", "FILE.rrec", "show what --record wrote of the same scene, without simulating", options.replay);
    reader.flag("--explain", "at the end, say what was chosen, what was left out, and what the rest cost", options.explain);
    reader.option("--preset", "NAME", "one of the scene's sets of values, before any --set", preset);
    reader.option("--set", "PATH=VALUE", "change a parameter: --set fluid.spacing=0.02; as often as you like", assignments);
    if (std::optional<int> code = reader.read(arguments)) return *code;

    if (Status sense = settleBackend(options.backend, "auto", options.device); !sense) return report(sense.error());
    std::vector<std::string> cooperations = plans().names();
    cooperations.emplace_back("auto");
    if (Status known = checkWord("plan", options.cooperate, cooperations); !known) return report(known.error());
    options.sized = !size.empty();
    Result<std::pair<int, int>> pixels = parseSize(options.sized ? size : "1280x720");
    if (!pixels) return report(pixels.error());
    std::tie(options.width, options.height) = *pixels;
    if (noRender && !options.video.empty())
        return report(badInput("--video asks for pictures and --no-render for none; leave one of them out"));

    if (noRender && !stills.empty()) return report(badInput("--still asks for pictures and --no-render for none; leave one of them out"));
    Result<SceneFile> loaded = loadScene(scene, assignments, preset);
    if (!loaded) return report(loaded.error());
    for (const std::string& still : stills) {
        Result<int> frame = frameAt(still, *loaded);
        if (!frame) return report(frame.error());
        options.stills.insert(*frame);
    }
    if (loaded->budget.frameMs > 0 && (!options.save.empty() || !options.resume.empty()))
        return report(
            badInput("a budget picks anew at each start, and what is saved would not fit: --set budget.frameMs=0, and the method and "
                     "spacing that you want"));
    if (!loaded->flow.empty() && (!options.save.empty() || !options.resume.empty()))
        return report(badInput(fmt::format("a state holds no skins, and {} has some: leave --save and --resume out", loaded->name)));
    if (!loaded->flow.empty() && (!options.record.empty() || !options.replay.empty()))
        return report(badInput(fmt::format("a recording holds no skins, and {} has some: leave --record and --replay out", loaded->name)));
    if (!options.replay.empty())
        if (Status sense = checkReplay(options, noRender); !sense) return report(sense.error());
    options.scene = std::move(*loaded);
    if (!options.replay.empty()) {
        options.scene.budget.frameMs = 0;  // nothing is simulated that could be too slow
        options.backend = "cpu";
        options.scene.fluid.grid = "sorted";  // nothing looks for neighbours; the cpu has no other
    }
    options.render = !noRender;
    if (seconds) {
        Result<int> frames = framesOf(*seconds, options.scene, "--seconds");
        if (!frames) return report(frames.error());
        options.frames = *frames;
    }
    options.log = stderrLog();

    if (!headless && !noRender && !hasDisplay()) {
        options.log.notice("there is no display: running headless");
        headless = true;
    }
    if (!options.stills.empty()) headless = true;
    return headless || noRender ? runHeadless(options) : runWindow(options);
}

}  // namespace rivulet
