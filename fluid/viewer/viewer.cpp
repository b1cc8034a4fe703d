#include "fluid/viewer/viewer.h"

#include <rivulet_glad/gl.h>

#include <algorithm>
#include <mutex>
#include <utility>

#include "fluid/session/autotune.h"
#include "fluid/session/cpu_fallback.h"

namespace rivulet {

Result<std::unique_ptr<Viewer>> Viewer::create(const SceneFile& scene, const ViewerOptions& options, const Log& log) {
    Result<UiLayer> ui = UiLayer::create(options.clipboard);
    if (!ui) return ui.error();
    std::unique_ptr<Viewer> viewer(new Viewer(std::move(*ui)));
    // Notices of the program appear in the panel too.
    viewer->log_.sink = [log, one = std::make_shared<std::mutex>(), kept = viewer->notices_](LogLevel level, std::string_view text) {
        const std::lock_guard<std::mutex> lock(*one);  // at a time
        if (log.sink) log.sink(level, text);
        if (level >= LogLevel::notice) kept->add(text);
    };
    if (Status started = viewer->start(scene, options); !started) return started.error();
    return viewer;
}

Status Viewer::start(const SceneFile& scene, const ViewerOptions& options) {
    gl_ = currentGlFacts();
    welcomeScreen_ = WelcomeScreen(options.seen);
    clDevice_ = options.device;
    longestStep_ = options.longestStep;
    askStep_ = options.askStep;
    opener_.begin(options.share, clDevice_, gl_, log_);
    std::string backend = options.backend;
    OpenedScene first;
    if (options.showing && options.share && options.cooperate != "auto") {
        first.device = makeDevice(backend, gl_, log_, clDevice_);
        first.device->stopOn(options.stop);
        if (opener_.aside()) {
            Result<OpenedScene> shown = openShowing(scene, options, backend, std::move(first.device));
            if (!shown) return shown.error();
            first = std::move(*shown);
        }
    }
    if (!first.renderer) {
        const auto surroundings = surroundingsOf(scene);
        if (!surroundings) return surroundings.error();
        auto renderer = SceneRenderer::create(ShaderFiles::developer(), *surroundings ? &**surroundings : nullptr, log_);
        if (!renderer) return renderer.error();
        first.renderer = std::move(*renderer);
    }
    picture_.adopt(std::move(first.renderer), run_.timeline());
    Plan plan = Plan::alone;
    std::vector<CooperationStats::Tried> trials;
    if (options.cooperate == "auto") {
        const DrawFrame draw = [&](Session& session, const std::function<void()>& uploaded, std::vector<PassTime>& passes) -> Status {
            if (Status drawn = picture_.draw(session, options.width, options.height, run_.timeline(), uploaded); !drawn) return drawn;
            picture_.renderer().finish();
            passes = renderer().times();
            return ok();
        };
        log_.notice("--cooperate auto first tries every plan on every device; this takes some seconds");
        Result<std::vector<PlanTried>> tried = tryPlans({.scene = scene, .gl = gl_, .draw = draw, .log = log_, .clDevice = clDevice_});
        if (!tried) return tried.error();
        log_.notice(sentenceOf(*tried, backend));
        backend = tried->front().backend;
        plan = tried->front().plan;
        trials = statsOf(*tried);
    } else {
        plan = plans().find(options.cooperate)->plan;
    }
    if (!first.session) {
        if (!first.device) first.device = makeDevice(backend, gl_, log_, clDevice_);
        first.device->stopOn(options.stop);
        auto opened = openSession(scene, *first.device, log_, backend);
        if (!opened) return opened.error();
        if (opened->instead) first.device = std::move(opened->instead);
        first.session = std::move(opened->session);
    }
    asked_ = backend;
    run_.begin(plan, std::move(trials), log_, options.stop);
    run_.adopt(std::move(first.session), std::move(first.device));
    draft_.scene = this->scene();
    rememberOpened(false);
    run_.pause(welcomeScreen_.shown());  // nothing happens behind it
    picture_.begin(gl_.software);
    reload_.follow(scene);
    return ok();
}

Viewer::~Viewer() {
    if (Status closed = capture_.endVideo(log_); !closed) log_.notice(closed.error().message);
    if (Status closed = recording_.end(log_); !closed) log_.notice(closed.error().message);
}

Status Viewer::frame(const InputEvents& input, double seconds, GLuint framebuffer) {
    edited_ = false;
    if (Status done = take(run_.finish(seconds, renderer().times(), false)); !done) return done;
    opener_.collect();
    if (opener_.ready()) finishOpening();
    if (opening() == nullptr) takeWritten(seconds);  // what is being opened would miss it
    ui_.begin(input, seconds);
    const bool greets = welcomeScreen_.shown();  // the key that ends it does nothing else
    if (!greets) takeKeys(input);
    drawPanels();
    drawDialogs(input, seconds);
    if (greets && !welcomeScreen_.shown()) run_.pause(false);
    ui_.made();
    takeDropped(input);
    takeMouse(input, greets);
    const bool recreate = std::exchange(anew_, false);
    if (edited_ || recreate) {
        takeEdits(recreate);
        draft_.params.compare(visiting(draft_.scene));
    }
    if (Status stepped = take(run_.step(seconds, renderer().times())); !stepped) return stepped;
    if (session().interrupted()) return ok();  // there is nothing valid to draw
    Status drawn = draw(input, framebuffer);
    profiler_.endFrame(1000 * seconds);
    return drawn;
}

void Viewer::report(const Status& status) {
    if (!status) message_ = status.error().message;
}

// Shows the results of a step.
Status Viewer::take(SceneRun::Result result) {
    if (!result) return result.error();
    if (!*result) return ok();
    const SceneRun::Stepped& step = **result;
    capture_.stepped();
    report(recording_.stepped(session()));
    if (step.toCpu) draft_.scene.fluid.grid = scene().fluid.grid;  // the cpu may not support it
    if (step.repicked) draft_.scene.fluid = scene().fluid;
    profiler_.add("simulate", step.passes);
    constexpr double kNew = 0.2;
    const double ms = std::max(step.ms, step.deviceMs);
    stepMs_ = stepMs_ > 0 ? (1 - kNew) * stepMs_ + kNew * ms : ms;
    watch_.stepped(session(), ms);
    return ok();
}

const Timeline& Viewer::wholeTimeline() {
    picture_.renderer().finish();
    return run_.wholeTimeline();
}

RunStats Viewer::finishRecord() {
    picture_.renderer().finish();
    return run_.finishRecord();
}

Status Viewer::draw(const InputEvents& input, GLuint framebuffer) {
    const int width = input.framebuffer.x, height = input.framebuffer.y;
    if (width <= 0 || height <= 0) {
        run_.stepOn();
        ui_.draw(framebuffer, 0, 0);
        return ok();
    }
    if (Status drawn = picture_.draw(session(), width, height, run_.timeline(), [this] { run_.stepOn(); }); !drawn) {
        if (!reload_.broken()) return drawn;
        report(drawn);  // a program that is wanted for the first time: the last picture stays
    }
    run_.transferred(picture_.facts());
    report(capture_.film(renderer(), log_));
    renderer().present(framebuffer, width, height);
    ui_.draw(framebuffer, width, height);
    profiler_.add("render", renderer().times());
    if (renderer().times().empty()) return ok();  // none has come back yet
    const PassTime ui[] = {{.name = "ui", .ms = ui_.ms(), .calls = 1}};
    profiler_.add("render", ui);
    picture_.adaptQuality(scene().look);
    return ok();
}

}  // namespace rivulet
