#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <set>

#include "demos/rivulet/cli.h"
#include "demos/rivulet/interrupt.h"
#include "demos/rivulet/run_options.h"
#include "engine/app/capture.h"
#include "engine/app/context_egl.h"
#include "engine/core/file.h"
#include "engine/core/message_line.h"
#include "engine/core/wall_clock.h"
#include "engine/gpu/gl_error.h"
#include "fluid/render/backend.h"
#include "fluid/render/fluid_upload.h"
#include "fluid/session/autotune.h"
#include "fluid/session/cooperation.h"
#include "fluid/session/cpu_fallback.h"
#include "fluid/session/explain.h"
#include "fluid/session/run_stats.h"
#include "fluid/session/scene_renderer.h"
#include "fluid/session/session.h"

namespace rivulet {

namespace {

using Clock = std::chrono::steady_clock;

// The frames from `first` to before `end` that are written as PNG: the first, the last, and four at equal distances between them.
std::set<int> pictureFrames(int first, int end) {
    constexpr int kPictures = 6;
    std::set<int> chosen;
    for (int k = 0; k < kPictures && end > first; ++k)
        chosen.insert(first + static_cast<int>(std::lround(static_cast<double>(end - first - 1) * k / (kPictures - 1))));
    return chosen;
}

// The output files. Opened before the first step, so that a file that cannot be written is reported before the work starts.
struct Outputs : OutputNames {
    std::optional<VideoWriter> writer;

    static Result<Outputs> open(const RunOptions& options) {
        Outputs to{namesOf(options), {}};
        if (options.render || options.stats.empty())
            if (Status made = makeFolder(options.out); !made) return made.error();
        if (options.replay.empty())
            if (Status writable = checkWritable(to.stats); !writable) return writable.error();
        for (const std::string& file : {options.save, options.trace})
            if (!file.empty())
                if (Status writable = checkWritable(file); !writable) return writable.error();
        if (!options.render || options.images || !options.stills.empty()) return to;
        Result<VideoWriter> video = VideoWriter::open(to.video, options.width, options.height, kFramesPerSecond);
        if (!video) return video.error();
        to.writer = std::move(*video);
        return to;
    }
};

// Draws a session's frames into an image in memory.
struct Painter {
    std::unique_ptr<SceneRenderer> renderer;
    FluidUpload upload;
    Timeline* timeline = nullptr;

    // RGBA pixels of the frame. `uploaded` is called once the world is no longer read, so that its next step may start.
    Result<std::vector<uint8_t>> paint(Session& session, int width, int height, const std::function<void()>& uploaded) {
        const SceneFile& scene = session.scene();
        std::optional<TimedSpan> uploading(std::in_place, timeline, "main", "upload");
        Result<FluidView> fluid = viewOf(upload, session);
        if (!fluid) return fluid.error();
        if (Status wet = session.flows().draw(); !wet) return wet.error();
        FrameView view = frameViewOf(cameraOf(scene.camera, session.bounds()), scene.light, width, height, session.time());
        uploading.reset();
        uploaded();
        {
            const TimedSpan span(timeline, "main", "draw");
            if (Status drawn = renderer->draw(view, *fluid, session.solids(), scene); !drawn) return drawn.error();
        }
        const TimedSpan span(timeline, "main", "read pixels");
        std::vector<uint8_t> pixels = renderer->pixels();
        if (gpu::contextLost()) return failed(gpu::kContextLost);
        return pixels;
    }
};

struct Loop {
    const RunOptions& options;
    const Graceful& graceful;
    Session& session;
    std::unique_ptr<Device>& device;
    Outputs& to;
    Painter& painter;
    Cooperation& work;
    std::optional<RunRecorder> recorder;       // empty: a replay has no statistics
    std::optional<RecordingWriter> recording;  // of --record
    int pictures = 0;

    // Writes the height field of each skin in thesis mode, beside the image of frame `f`.
    Status writeHeights(int f) {
        const auto& skins = session.flows().skins();
        for (size_t k = 0; k < skins.size(); ++k) {
            const ThesisPicture& p = skins[k]->picture();
            if (p.size == 0) continue;
            const std::string path = fmt::format("{}_{:04}_height{}.png", to.picturePrefix, f, k == 0 ? "" : std::to_string(k));
            if (Status written = writePng(path, greyOf(p), p.size, p.size); !written) return written;
        }
        return ok();
    }

    Status run(int frames) {
        const int first = options.first.value_or(0);
        const std::set<int> some = options.stills.empty() ? pictureFrames(first, frames) : options.stills;
        const auto kept = [&](int f) { return options.images || some.contains(f); };
        Progress progress(options.scene.name);
        double now = 0;  // s, the simulated time that is drawn
        if (options.render)
            painter.renderer->onProgress([&](double share) {
                progress.show(share, fmt::format("drawing {:.2f} s", now));
                return !graceful.interrupted();
            });
        // With the plan `behind`, a step that runs while the last image is drawn is drawn too, so that --save writes the state of the last
        // image.
        const auto continues = [&] { return !graceful.interrupted() || (work.started() && work.plan() == Plan::behind); };
        for (int f = first; f < frames && continues(); ++f) {
            const bool shown = options.render && (to.writer || kept(f));
            if (session.replaying() != nullptr && !shown) continue;
            if (session.replaying() != nullptr) session.seek(static_cast<size_t>(f));
            Clock::time_point start = Clock::now();
            const double simulateMs = work.started() ? work.finish() : work.step(frameSeconds(options.scene), true);
            if (session.interrupted()) break;
            const Result<bool> moved = keepRunning(session, device, options.log);
            if (!moved) return moved.error();
            if (*moved) {
                if (recorder) recorder->follow(session.world());
                if (work.timeline() != nullptr) traceKernels(*device, *work.timeline());
            }
            if (recorder) recorder->stepped(simulateMs, device->takeTimes());
            if (recording)
                if (Status added = recording->add(frameOf(session)); !added) return added;
            now = session.time();
            double renderMs = 0;
            std::vector<PassTime> drawn;
            if (shown) {
                Clock::time_point before = Clock::now();
                Result<std::vector<uint8_t>> pixels = painter.paint(session, options.width, options.height, [&] {
                    if (f + 1 < frames && !graceful.interrupted()) work.start(frameSeconds(options.scene), true);
                });
                if (!pixels) return pixels.error();
                renderMs = msSince(before);
                drawn = painter.renderer->times();
                if (recorder) recorder->transferred(painter.upload.facts());
                if (to.writer)
                    if (Status added = to.writer->add(*pixels); !added) return added;
                if (kept(f)) {
                    if (Status written = writePng(fmt::format("{}_{:04}.png", to.picturePrefix, f), *pixels, options.width, options.height);
                        !written)
                        return written;
                    if (Status written = writeHeights(f); !written) return written;
                    ++pictures;
                }
            }
            if (options.render && !shown)  // a skin's maps accumulate, so they are drawn in every frame
                if (Status wet = session.flows().draw(); !wet) return wet.error();
            if (recorder) recorder->drawn(renderMs, msSince(start), drawn);
            progress.show(static_cast<double>(f + 1 - first) / (frames - first),
                          fmt::format("{:.2f} s, {:.0f} ms a frame", now, msSince(start)));
        }
        work.drop();
        return ok();
    }
};

struct PlanChoice {
    std::string backend;  // as --backend
    Plan plan = Plan::alone;
    std::vector<CooperationStats::Tried> tried = {};
};

// The plan of --cooperate; auto measures all of them and takes the fastest.
Result<PlanChoice> choosePlan(const RunOptions& options, const GlFacts& gl, Painter& painter) {
    if (!options.render && options.cooperate != "off") {
        options.log.notice(
            fmt::format("--cooperate {} has no effect: nothing is drawn, so that CPU and GPU have no work to share", options.cooperate));
        return PlanChoice{.backend = options.backend};
    }
    if (options.cooperate != "auto") return PlanChoice{.backend = options.backend, .plan = plans().find(options.cooperate)->plan};
    const DrawFrame draw = [&](Session& session, const std::function<void()>& uploaded, std::vector<PassTime>& passes) -> Status {
        Result<std::vector<uint8_t>> pixels = painter.paint(session, options.width, options.height, uploaded);
        if (!pixels) return pixels.error();
        passes = painter.renderer->times();
        return ok();
    };
    Result<std::vector<PlanTried>> tried = [&] {
        Progress progress("trying plans");
        return tryPlans({.scene = options.scene,
                         .gl = gl,
                         .draw = draw,
                         .log = options.log,
                         .clDevice = options.device,
                         .progress = [&](double share, const std::string& plan) { progress.show(share, plan); }});
    }();
    if (!tried) return tried.error();
    options.log.notice(sentenceOf(*tried, options.backend));
    return PlanChoice{tried->front().backend, tried->front().plan, statsOf(*tried)};
}

}  // namespace

int runHeadless(const RunOptions& options) {
    // OpenGL is opened if images are drawn or the backend may be gl. Its absence is an error only if images are drawn.
    std::optional<ContextEgl> context;
    GlFacts gl = noGl("OpenGL was not requested");
    if (options.render || options.backend == "gl" || options.backend == "auto") {
        Result<ContextEgl> made = ContextEgl::create();
        if (!made && options.render)
            return report(
                failed(fmt::format("drawing needs OpenGL: {}; use --no-render to simulate without images", made.error().message)));
        gl = made ? currentGlFacts() : noGl(made.error().message);
        if (made) context = std::move(*made);
    }
    Timeline timeline;  // declared first: it must outlive all that report spans to it
    Painter painter;
    if (options.render) {
        const auto surroundings = surroundingsOf(options.scene);
        if (!surroundings) return report(surroundings.error());
        auto renderer = SceneRenderer::create(ShaderFiles::developer(), *surroundings ? &**surroundings : nullptr, options.log);
        if (!renderer) return report(renderer.error());
        painter.renderer = std::move(*renderer);
    }
    const Result<PlanChoice> choice = choosePlan(options, gl, painter);
    if (!choice) return report(choice.error());
    const bool traced = !options.trace.empty() || options.cooperate != "off";
    std::unique_ptr<Device> device = makeDevice(choice->backend, gl, options.log, options.device);
    std::optional<Progress> opening(std::in_place, options.scene.name);
    auto opened = openSession(options.scene, *device, options.log, choice->backend, opening->steps());
    opening.reset();
    if (!opened) return report(opened.error());
    if (opened->instead) device = std::move(opened->instead);
    const std::unique_ptr<Session> session = std::move(opened->session);
    if (!options.resume.empty())
        if (Status resumed = resumeFrom(options.resume, *session); !resumed) return report(resumed.error());
    if (Status replays = replayOf(options, *session); !replays) return report(replays.error());
    const Replay* replay = session->replaying();
    int frames = options.frames.value_or(0);
    if (!options.stills.empty() && !options.frames) {
        frames = *options.stills.rbegin() + 1;
    } else if (!options.frames) {
        const double left = std::max(static_cast<double>(options.scene.duration) - session->world().time(), 0.0);  // less if resumed
        Result<int> all = framesOf(left, options.scene, "duration");
        if (!all) return report(all.error());
        frames = *all;
    }
    if (replay != nullptr) {
        const int recorded = static_cast<int>(replay->frames());
        if (options.stills.empty() && !options.frames) frames = recorded;
        if (!options.stills.empty() && *options.stills.rbegin() >= recorded)
            return report(badInput(fmt::format("--still: {} ends with frame {}, at {:.3g} s; use an earlier time", options.replay,
                                               recorded - 1, recorded * frameSeconds(options.scene))));
        if (options.first && frames > recorded)
            return report(badInput(fmt::format("--frames {}:{}: {} has {} frames; end at {} or before", *options.first, frames,
                                               options.replay, recorded, recorded)));
        frames = std::min(frames, recorded);
    }
    if (traced) {
        timeline.restart();  // drops times of the trials of auto that arrive late
        painter.timeline = &timeline;
        traceKernels(*device, timeline);
        if (painter.renderer) painter.renderer->onSpan(timeline.lane(kDrawingLane));
    }
    Graceful graceful;                                          // before this line Ctrl-C exits at once; after it, files are closed first
    if (options.save.empty()) device->stopOn(graceful.flag());  // a state is saved after a whole frame
    Result<Outputs> to = Outputs::open(options);
    if (!to) return report(to.error());

    Result<std::optional<RecordingWriter>> recording = recordingOf(options, *session);
    if (!recording) return report(recording.error());

    Cooperation work(*session, choice->plan, traced ? &timeline : nullptr, options.log);
    Loop loop{options, graceful, *session, device, *to, painter, work, {}, std::move(*recording)};
    if (replay == nullptr) loop.recorder.emplace(session->world(), session->fields(), true, &session->flows());
    if (Status done = loop.run(frames); !done) return report(done.error());
    if (painter.renderer) painter.renderer->finish();
    device->finish();
    (void)device->takeTimes();  // the last frames' spans
    if (loop.recording)
        if (Status closed = loop.recording->close(); !closed) return report(closed.error());
    if (to->writer)
        if (Status closed = to->writer->close(); !closed) return report(closed.error());
    if (!options.trace.empty())
        if (Status written = writeTrace(options.trace, timeline, options.log); !written) return report(written.error());
    const std::string shown = fmt::format("{}{} image{} {}_*.png", to->writer ? to->video + ", " : "", loop.pictures,
                                          loop.pictures == 1 ? "" : "s", to->picturePrefix);
    if (!loop.recorder) {
        fmt::print("{}\n", printable(shown));
        return graceful.status();
    }
    if (Status sound = stillWorks(*device); !sound) return report(sound.error());
    RunStats stats = loop.recorder->finish(options.scene.name);
    stats.cooperation = work.stats();
    stats.cooperation.tried = choice->tried;
    if (Status written = writeFileAtomic(to->stats, writeRunStats(stats)); !written) return report(written.error());

    if (!options.save.empty())
        if (Status saved = saveTo(options.save, *session); !saved) return report(saved.error());

    std::string where = to->stats;
    if (options.render && stats.frames > 0) where = fmt::format("{} and {}", shown, to->stats);
    if (!options.save.empty()) where += fmt::format(" and {}", options.save);
    if (loop.recording)
        where += fmt::format(" and {}, {} frames, {:.1f} MB", options.record, loop.recording->frames(),
                             1.0e-6 * static_cast<double>(loop.recording->bytes()));
    if (options.explain) fmt::print("{}", explain(*session, stats));
    fmt::print("{}\n", printable(where));
    return graceful.status();
}

}  // namespace rivulet
