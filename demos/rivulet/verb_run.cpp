#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "demos/rivulet/cli.h"
#include "demos/rivulet/outputs.h"
#include "demos/rivulet/run_options.h"
#include "engine/core/number.h"
#include "fluid/render/backend.h"
#include "fluid/render/renderers.h"
#include "fluid/scene/scene_inputs.h"
#include "fluid/session/cooperation.h"
#include "fluid/session/session.h"

namespace rivulet {

namespace {

bool hasDisplay() {
    auto isSet = [](const char* variable) {
        const char* value = std::getenv(variable);
        return value != nullptr && *value != '\0';
    };
    return isSet("DISPLAY") || isSet("WAYLAND_DISPLAY");
}

// The frame number at the time `text`, s, of --still.
Result<int> frameAt(const std::string& text, const SceneFile& scene) {
    double at = -1;
    if (!parseNumber(text, at) || !(at >= 0))
        return badInput(fmt::format("--still must be a time in seconds, 0 or more, but is '{}'", text));
    return framesOf(at, scene, fmt::format("--still {}", text));
}

// "120": a number of frames; "30:60": the frames from 30 to before 60 of a recording.
Status readFrames(const std::string& text, RunOptions& options) {
    const size_t colon = text.find(':');
    const auto number = [](std::string_view digits) -> std::optional<int> {
        int value = -1;
        return parseNumber(digits, value) && value >= 0 && value <= kMostFrames ? std::optional(value) : std::nullopt;
    };
    if (colon != std::string::npos) {
        options.first = number(std::string_view(text).substr(0, colon));
        options.frames = number(std::string_view(text).substr(colon + 1));
        if (!options.first || !options.frames || *options.first >= *options.frames)
            return badInput(
                fmt::format("--frames must be a number of frames, or the first frame of a piece and the one after its last, for "
                            "example 30:60, but is '{}'",
                            text));
        if (options.replay.empty())
            return badInput(
                fmt::format("--frames {} draws a piece of a recording; add --replay FILE.rrec, or give a number of frames", text));
        return ok();
    }
    options.frames = number(text);
    if (options.frames) return ok();
    return badInput(fmt::format("--frames must be a whole number from 0 to {}, or a piece of a recording, for example 30:60, but is '{}'",
                                kMostFrames, text));
}

// A replay simulates nothing, so that it has no statistics and no state: options that need them are refused.
Status checkReplay(const RunOptions& options, bool noRender) {
    for (const auto& [name, used] : {std::pair("--record", !options.record.empty()), std::pair("--save", !options.save.empty()),
                                     std::pair("--resume", !options.resume.empty()), std::pair("--stats", !options.stats.empty()),
                                     std::pair("--explain", options.explain), std::pair("--no-render", noRender),
                                     std::pair("--cooperate", options.cooperate != "off")})
        if (used) return badInput(fmt::format("{} cannot be used with --replay, which simulates nothing; leave one of them out", name));
    return ok();
}

// The names of all files that the run reads and writes are known before it starts.
Status checkFiles(const RunOptions& options, bool headless) {
    const OutputNames to = namesOf(options);
    const bool statistics = options.replay.empty() && (headless || !options.stats.empty());
    std::vector<NamedFile> outputs = {
        {"--stats", statistics ? to.stats : ""}, {"--trace", options.trace}, {"--save", options.save}, {"--record", options.record}};
    if (headless && options.render) {
        outputs.push_back({"--video", options.stills.empty() && !options.images ? to.video : ""});
        outputs.push_back({"--out", to.picturePrefix + "_*.png", true});
    }
    std::vector<NamedFile> inputs = {{"--resume", options.resume}, {"--replay", options.replay}};
    for (const SceneInput& input : inputsOf(options.scene)) inputs.push_back({input.name, input.path});
    return checkOutputs(outputs, inputs);
}

}  // namespace

OutputNames namesOf(const RunOptions& options) {
    const std::filesystem::path folder(options.out);
    const std::string prefix = (folder / fileNameOf(options.scene.name)).string();
    return {.stats = options.stats.empty() ? (folder / "stats.json").string() : options.stats,
            .video = options.video.empty() ? prefix + ".mp4" : options.video,
            .picturePrefix = prefix};
}

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
        fmt::format("{}: {:g} s at timeScale {:g} need {:g} frames, but at most {} are allowed; use fewer seconds or a larger timeScale",
                    place, seconds, scene.timeScale, frames, kMostFrames));
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
        return failed(fmt::format("{} {}: its data is invalid, so {} was not written", device.info().name, health.why, path));
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
    Result<RecordingWriter> file = RecordingWriter::open(options.record, recordedText(session));
    if (!file) return file.error();
    return std::optional(std::move(*file));
}

Result<std::optional<RunOptions>> readRun(const std::vector<std::string>& arguments) {
    ArgumentReader reader(
        "run", "Runs a scene in a window. Without a display, or with --headless, it writes a video, images and statistics instead.");
    std::string scene, size, frames, renderer;
    RunOptions options;
    std::vector<std::string> assignments;
    std::string preset;
    std::vector<std::string> stills;
    bool noRender = false;
    std::optional<double> seconds;
    reader.positional("SCENE", "a scene file, or the name of a scene in 'rivulet list scenes'", scene, true);
    reader.option("--backend", "NAME", "backend of the simulation: auto, cpu, gl or cl; default: auto", options.backend);
    reader.option("--device", "TEXT", "OpenCL device: part of its name, or its number in 'rivulet list devices'", options.device);
    reader.flag("--headless", "open no window; write a video, images and statistics", options.headless);
    reader.flag("--no-render", "draw nothing; simulate and write statistics", noRender);
    reader.option("--frames", "N|A:B", "number of frames; 60 frames are one second of video; A:B: of a recording, frames A to B - 1",
                  frames);
    reader.option("--seconds", "S", "simulated time, s; headless default: the scene's duration", seconds, 0,
                  static_cast<double>(kMostFrames) / kFramesPerSecond);
    reader.exclude("--seconds", "--frames");
    reader.option("--size", "WxH", "size of the image in pixels; default: 1280x720", size);
    reader.option("--out", "DIR", "output folder of video, images and statistics; default: out", options.out);
    reader.option("--video", "FILE.mp4", "video file; default: DIR/NAME.mp4", options.video);
    reader.option("--still", "S", "draw only the frame at this time, s, and no video; may be repeated", stills);
    reader.flag("--images", "draw an image of each frame, and no video; rivulet join makes the video", options.images);
    reader.option("--renderer", "NAME", "water renderer, as --set look.renderer=NAME; 'rivulet list renderers' describes each", renderer);
    reader.option("--stats", "FILE.json", "statistics file; default: DIR/stats.json", options.stats);
    reader.option("--cooperate", "PLAN", "how CPU and GPU share the work: off, thesis, behind, or auto, which measures all; default: off",
                  options.cooperate);
    reader.option("--trace", "FILE.json", "write a timeline of all passes, for chrome://tracing or Perfetto", options.trace);
    reader.option("--save", "FILE", "write the state at the end of the run, for --resume", options.save);
    reader.option("--resume", "FILE", "continue from a state of the same scene that --save wrote", options.resume);
    reader.option("--record", "FILE.rrec", "record every frame exactly, for --replay; not possible with flow on skins", options.record);
    reader.option("--replay", "FILE.rrec", "show a recording of the same scene without simulating", options.replay);
    reader.flag("--explain", "at the end, print which options were chosen, which passes were skipped, and the time of the others",
                options.explain);
    reader.option("--preset", "NAME", "a named set of values in the scene file, applied before --set", preset);
    reader.option("--set", "PATH=VALUE", "set a parameter, for example --set fluid.spacing=0.02; may be repeated", assignments);
    const Result<bool> read = reader.parse(arguments);
    if (!read) return read.error();
    if (!*read) return std::optional<RunOptions>();

    if (Status sense = settleBackend(options.backend, "auto", options.device); !sense) return sense.error();
    std::vector<std::string> cooperations = plans().names();
    cooperations.emplace_back("auto");
    if (!frames.empty())
        if (Status sense = readFrames(frames, options); !sense) return sense.error();
    if (!renderer.empty()) {
        if (Status known = checkWord("renderer", renderer, renderers().names()); !known) return known.error();
        assignments.push_back("look.renderer=" + renderer);
    }
    if (Status known = checkWord("plan", options.cooperate, cooperations); !known) return known.error();
    options.sized = !size.empty();
    Result<std::pair<int, int>> pixels = parseSize(options.sized ? size : "1280x720");
    if (!pixels) return pixels.error();
    std::tie(options.width, options.height) = *pixels;
    for (const auto& [name, used] : {std::pair("--video", !options.video.empty()), std::pair("--still", !stills.empty()),
                                     std::pair("--images", options.images), std::pair("--renderer", !renderer.empty())})
        if (noRender && used)
            return badInput(fmt::format("{} cannot be used with --no-render, which draws nothing; leave one of them out", name));
    for (const auto& [name, used] : {std::pair("--video", !options.video.empty()), std::pair("--still", !stills.empty())})
        if (options.images && used)
            return badInput(fmt::format("{} cannot be used with --images, which draws all frames as images; leave one of them out", name));
    if (options.first && !stills.empty())
        return badInput("--still cannot be used with a piece of --frames, which draws all its frames; leave one of them out");
    Result<SceneFile> loaded = loadScene(scene, assignments, preset);
    if (!loaded) return loaded.error();
    for (const std::string& still : stills) {
        Result<int> frame = frameAt(still, *loaded);
        if (!frame) return frame.error();
        options.stills.insert(*frame);
    }
    if (loaded->budget.frameMs > 0 && (!options.save.empty() || !options.resume.empty()))
        return badInput(
            "--save and --resume cannot be used with a budget, which chooses method and spacing at each start; add --set "
            "budget.frameMs=0 and set fluid.method and fluid.spacing");
    if (!loaded->flow.empty() && (!options.save.empty() || !options.resume.empty()))
        return badInput(
            fmt::format("a state file cannot store flow on skins, and {} has some; leave --save and --resume out", loaded->name));
    if (!loaded->flow.empty() && (!options.record.empty() || !options.replay.empty()))
        return badInput(
            fmt::format("a recording cannot store flow on skins, and {} has some; leave --record and --replay out", loaded->name));
    if (!options.replay.empty())
        if (Status sense = checkReplay(options, noRender); !sense) return sense.error();
    options.scene = std::move(*loaded);
    if (!options.replay.empty()) {
        options.scene.budget.frameMs = 0;  // nothing is simulated, so there is no time to limit
        options.backend = "cpu";
        options.scene.fluid.grid = "sorted";  // the only grid of the cpu; a replay searches no neighbours
    }
    options.render = !noRender;
    if (seconds) {
        Result<int> count = framesOf(*seconds, options.scene, "--seconds");
        if (!count) return count.error();
        options.frames = *count;
    }
    if (!options.stills.empty() || options.images || options.first) options.headless = true;
    return std::optional(std::move(options));
}

int runVerb(const Arguments& arguments) {
    Result<std::optional<RunOptions>> read = readRun(arguments);
    if (!read) return report(read.error());
    if (!*read) return kDone;
    RunOptions options = std::move(**read);
    options.log = stderrLog();
    if (!options.headless && options.render && !hasDisplay()) {
        options.log.notice("no display found: running headless");
        options.headless = true;
    }
    const bool windowless = options.headless || !options.render;
    if (Status apart = checkFiles(options, windowless); !apart) return report(apart.error());
    return windowless ? runHeadless(options) : runWindow(options);
}

}  // namespace rivulet
