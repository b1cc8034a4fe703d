#include <fmt/format.h>

#include <chrono>
#include <thread>

#include "demos/rivulet/cli.h"
#include "demos/rivulet/interrupt.h"
#include "demos/rivulet/run_options.h"
#include "engine/app/capture.h"
#include "engine/app/window_glfw.h"
#include "engine/core/file.h"
#include "engine/core/message_line.h"
#include "engine/gpu/gl_error.h"
#include "fluid/session/explain.h"
#include "fluid/viewer/viewer.h"

namespace rivulet {

namespace {
constexpr size_t kTitle = 80;  // characters
}

int runWindow(const RunOptions& options) {
    WindowGlfw::Options wish;
    wish.title = "opening " + messageLine(options.scene.name, kTitle) + " - rivulet";
    wish.width = options.width;
    wish.height = options.height;
    wish.scaled = !options.sized;
    Result<WindowGlfw> window = WindowGlfw::create(wish);
    if (!window) return report(window.error());
    Graceful graceful;
    bool closed = false;
    const auto showing = [&](const ViewerOptions::Draw& draw) {
        const InputEvents input = window->poll();
        closed = input.closed;
        if (closed || graceful.interrupted()) return false;
        draw(input, 0);
        window->swap();
        return true;
    };
    auto viewer = Viewer::create(options.scene,
                                 {.backend = options.backend,
                                  .device = options.device,
                                  .cooperate = options.cooperate,
                                  .clipboard = window->handle(),
                                  .width = options.width,
                                  .height = options.height,
                                  .seen = options.frames ? "" : seenFile(),  // no welcome screen with --frames
                                  .share = [&window] { return window->shared(); },
                                  .showing = showing,
                                  .stop = options.save.empty() ? graceful.flag() : nullptr},  // a state is saved after a whole frame
                                 options.log);
    if (graceful.interrupted()) return graceful.status();
    if (closed) return kDone;
    if (!viewer) return report(viewer.error());
    Viewer& v = **viewer;
    if (!options.resume.empty())
        if (Status resumed = resumeFrom(options.resume, v.session()); !resumed) return report(resumed.error());
    if (!options.save.empty())
        if (Status writable = checkWritable(options.save); !writable) return report(writable.error());
    for (const std::string& file : {options.stats, options.trace})
        if (!file.empty())
            if (Status writable = checkWritable(file); !writable) return report(writable.error());
    if (Status replays = replayOf(options, v.session()); !replays) return report(replays.error());
    Result<std::optional<RecordingWriter>> recording = recordingOf(options, v.session());
    if (!recording) return report(recording.error());
    if (*recording)
        v.onStepped([&](const Session& session) { return session.replaying() != nullptr ? ok() : (*recording)->add(frameOf(session)); });
    const bool recorded = options.explain || !options.stats.empty();
    if (recorded) v.record();
    if (options.frames) v.stepAtMost(static_cast<uint64_t>(*options.frames));

    std::string shown;
    auto last = std::chrono::steady_clock::now();
    while (!graceful.interrupted() && (!options.frames || v.steps() < static_cast<uint64_t>(*options.frames))) {
        InputEvents input = window->poll();
        if (input.closed) break;
        auto now = std::chrono::steady_clock::now();
        double seconds = std::chrono::duration<double>(now - last).count();
        last = now;
        if (Status drawn = v.frame(input, seconds, 0); !drawn) return report(drawn.error());
        if (gpu::contextLost()) return report(failed(gpu::kContextLost));
        window->swap();
        if (v.scene().name != shown) {
            shown = v.scene().name;
            window->setTitle(messageLine(shown, kTitle) + " - rivulet");
        }
        if (input.framebuffer.x <= 0 || input.framebuffer.y <= 0)
            std::this_thread::sleep_for(std::chrono::milliseconds(10));  // nothing paces it
    }
    if (Status settled = v.settle(); !settled) return report(settled.error());
    if (*recording)
        if (Status whole = (*recording)->close(); !whole) return report(whole.error());
    if (recorded) {
        const RunStats stats = v.finishRecord();
        if (!options.stats.empty())
            if (Status written = writeFileAtomic(options.stats, writeRunStats(stats)); !written) return report(written.error());
        if (options.explain) fmt::print("{}", explain(v.session(), stats));
    }
    if (!options.trace.empty())
        if (Status written = writeTrace(options.trace, v.wholeTimeline(), options.log); !written) return report(written.error());
    if (!options.save.empty())
        if (Status saved = saveTo(options.save, v.session()); !saved) return report(saved.error());
    return graceful.status();
}

}  // namespace rivulet
