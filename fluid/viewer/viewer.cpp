#include "fluid/viewer/viewer.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <utility>

#include "engine/core/assert.h"
#include "engine/core/thread_clock.h"
#include "fluid/session/autotune.h"
#include "fluid/session/cpu_fallback.h"
#include "fluid/viewer/scene_tree.h"

namespace rivulet {

namespace {

void drawHelp() {
    ImVec2 display = ImGui::GetIO().DisplaySize;
    constexpr struct {
        const char* key;
        const char* does;
    } kKeys[] = {{"left drag", "turn the view"},
                 {"right or middle drag", "move the view"},
                 {"wheel", "nearer, farther"},
                 {"click", "choose a mesh; a drop, on a skin"},
                 {"drag a body", "lift it, throw it"},
                 {"drag a handle", "move, turn what is chosen; control Z: back"},
                 {"P", "pour with the left button, till P again"},
                 {"space", "pause, go on"},
                 {"period", "one step"},
                 {"R", "start again"},
                 {"O", "open another scene"},
                 {"control S", "save the scene"},
                 {"control F", "find a parameter"},
                 {"drop a file", "a mesh, a scene, a sky"},
                 {"F9", "a video, till F9 again"},
                 {"F12", "a picture, without panels"},
                 {"Tab", "show, hide the panels"},
                 {"control plus, minus", "larger, smaller panels; 0: as before"},
                 {"H", "show, hide this"}};
    ImGui::SetNextWindowPos(ImVec2(display.x / 2, display.y / 2), ImGuiCond_Always, ImVec2(0.5F, 0.5F));
    ImGui::Begin("keys", nullptr,
                 ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_AlwaysAutoResize);
    for (const auto& row : kKeys) {
        ImGui::TextUnformatted(row.key);
        ImGui::SameLine(ImGui::GetFontSize() * 12);
        ImGui::TextDisabled("%s", row.does);
    }
    ImGui::Dummy(ImVec2(ImGui::GetFontSize() * 24, 1));
    ImGui::End();
}

}  // namespace

VisitFn Viewer::visiting(SceneFile& scene) {
    return [&scene](ParamVisitor& v) { scene.visit(v); };
}

Result<std::unique_ptr<Viewer>> Viewer::create(const SceneFile& scene, const ViewerOptions& options, const Log& log) {
    Result<UiLayer> ui = UiLayer::create(options.clipboard);
    if (!ui) return ui.error();
    std::unique_ptr<Viewer> viewer(new Viewer(std::move(*ui)));
    Viewer& v = *viewer;
    // What is said to the person at the program is said in the panel too.
    v.log_.sink = [log, one = std::make_shared<std::mutex>(), kept = v.notices_](LogLevel level, std::string_view text) {
        const std::lock_guard<std::mutex> lock(*one);  // at a time
        if (log.sink) log.sink(level, text);
        if (level >= LogLevel::notice) kept->add(text);
    };
    v.gl_ = currentGlFacts();
    v.welcomeScreen_ = WelcomeScreen(options.seen);
    v.share_ = options.share;
    v.clDevice_ = options.device;
    v.longestStep_ = options.longestStep;
    std::string backend = options.backend;
    OpenedScene first;
    if (options.showing && options.share && options.cooperate != "auto") {
        v.device_ = makeDevice(backend, v.gl_, v.log_, options.device);
        Result<SharedGl> made = options.share();
        if (made) {
            v.elsewhere_ = std::move(*made);
            v.share_ = {};
            Result<OpenedScene> shown = v.openShowing(scene, options, backend);
            if (!shown) return shown.error();
            first = std::move(*shown);
        }
    }
    v.renderer_ = std::move(first.renderer);
    if (!v.renderer_) {
        const auto surroundings = surroundingsOf(scene);
        if (!surroundings) return surroundings.error();
        auto renderer = SceneRenderer::create(ShaderFiles::developer(), *surroundings ? &**surroundings : nullptr);
        if (!renderer) return renderer.error();
        v.renderer_ = std::move(*renderer);
    }
    if (options.cooperate == "auto") {
        const DrawFrame draw = [&](Session& session, const std::function<void()>& uploaded, std::vector<PassTime>& passes) -> Status {
            if (Status drawn = v.drawWater(session, options.width, options.height, uploaded); !drawn) return drawn;
            v.renderer_->finish();
            passes = v.renderer_->times();
            return ok();
        };
        v.log_.notice("--cooperate auto tries every plan on every device first: some seconds");
        Result<std::vector<PlanTried>> tried =
            tryPlans({.scene = scene, .gl = v.gl_, .draw = draw, .log = v.log_, .clDevice = options.device});
        if (!tried) return tried.error();
        v.log_.notice(sentenceOf(*tried, backend));
        backend = tried->front().backend;
        v.plan_ = tried->front().plan;
        v.tried_ = statsOf(*tried);
    } else {
        v.plan_ = plans().find(options.cooperate)->plan;
    }
    if (first.session) {
        v.device_ = std::move(first.device);
        v.session_ = std::move(first.session);
    } else {
        if (!v.device_) v.device_ = makeDevice(backend, v.gl_, v.log_, options.device);
        auto opened = openSession(scene, *v.device_, v.log_, backend);
        if (!opened) return opened.error();
        if (opened->instead) v.device_ = std::move(opened->instead);
        v.session_ = std::move(opened->session);
    }
    v.asked_ = backend;
    v.timeline_.restart();  // times of what auto tried may be on their way
    traceKernels(*v.device_, v.timeline_);
    v.renderer_->onSpan(v.timeline_.lane(kDrawingLane));
    v.begin();
    v.draft_ = v.session_->scene();
    v.rememberOpened(false);
    v.adaptiveQuality_.begin(v.gl_.software);
    v.renderer_->hurry(v.adaptiveQuality_.fast());
    v.reload_.follow(scene);
    return viewer;
}

Status Viewer::frame(const InputEvents& input, double seconds, GLuint framebuffer) {
    edited_ = false;
    if (work_->plan() == Plan::behind && work_->started())
        if (Status done = stepped(work_->finish(), seconds); !done) return done;
    std::erase_if(givenUp_, [](const std::unique_ptr<SceneOpening>& each) { return each->ready(); });
    if (opening_ && opening_->work->ready()) finishOpening();
    if (!opening_) takeWritten(seconds);  // what is being opened would not hear of it
    const double began = threadSeconds();
    InputEvents scaled = input;
    scaled.scale *= zoom_;
    ui_.begin(scaled, seconds);
    const bool greets = welcomeScreen_.shown();  // the key that ends it does nothing else
    if (!greets && input.pressed(key::kEscape) && (saving_ || browser_.shown() || showHelp_)) closeTopmost();
    if (!greets && !ui_.wantsKeyboard()) takeKeys(input);
    if (!greets) takeKeysAlways(input);
    bool recreate = showPanels_ && drawPanels();
    if (!showPanels_) {
        watch_.hide(*renderer_);
        drawSaid(seconds);
    }
    if (showHelp_) drawHelp();
    if (opening_) drawOpening();
    reload_.draw();
    if (saving_) drawSaving();
    if (browser_.shown()) chooseScene();
    welcomeScreen_.draw(input);
    panelCost_.made = 1000 * (threadSeconds() - began);
    takeDropped(input);
    const Camera camera = cameraOf(draft_.camera, session_->bounds());
    const bool pours = !greets && brush_.take(input, camera, *session_, ui_.wantsMouse());
    brush_.draw(input, camera, *session_);
    if (brush_.pours() && session_->world().stats().particles >= session_->world().particles().count)
        message_ = fmt::format("the {} litres that pour.litres makes room for are poured: raise it to pour more", draft_.pour.litres);
    if (!greets && !pours && (!ui_.wantsMouse() || hand_.holds()) && !handle(input, recreate)) {
        moveCamera(input);
        touch(input);
    }
    hand_.draw(input, camera, *session_, draft_);
    recreate = std::exchange(anew_, false) || recreate;
    if (edited_ || recreate) {
        takeEdits(recreate);
        params_.compare(visiting(draft_));
    }
    if (Status stepped = step(seconds); !stepped) return stepped;
    Status drawn = draw(input, framebuffer);
    profiler_.endFrame(1000 * seconds);
    return drawn;
}

void Viewer::takeKeys(const InputEvents& input) {
    if (input.pressed(GLFW_KEY_SPACE)) paused_ = !paused_;
    if (input.pressed(GLFW_KEY_PERIOD)) paused_ = stepOnce_ = true;
    if (input.pressed(GLFW_KEY_R)) session_->reset();
    if (input.pressed('P')) turnBrush();
    if (input.pressed(GLFW_KEY_TAB)) {
        showPanels_ = !showPanels_;
        hand_.choose({});
    }
    if (input.pressed(GLFW_KEY_H)) showHelp_ = !showHelp_;
    const bool control = input.down(key::kLeftControl) || input.down(key::kRightControl);
    if (input.pressed(key::kEscape)) {
        hand_.choose({});
        brush_.turn(false);
    }
    if (control && input.pressed('Z')) {
        if (Manipulator::Asks asks; hand_.undo(draft_, asks)) {
            edited_ = true;
            anew_ = asks.recreate;
        } else if (left_) {
            open(*std::exchange(left_, std::nullopt));
        }
    }
    constexpr float kZoom = 1.25F;
    if (control && (input.pressed('=') || input.pressed('+'))) zoom_ = std::min(zoom_ * kZoom, 4.0F);
    if (control && input.pressed('-')) zoom_ = std::max(zoom_ / kZoom, 0.5F);
    if (control && input.pressed('0')) zoom_ = 1;
    if (input.pressed('O')) browser_.show(!browser_.shown());
}

// Also while a field is typed into.
void Viewer::takeKeysAlways(const InputEvents& input) {
    const bool control = input.down(key::kLeftControl) || input.down(key::kRightControl);
    if (control && input.pressed('S')) saving_ = true;
    if (control && input.pressed('F')) showPanels_ = params_.find = true;
    const auto say = [this](const Status& done) {
        if (!done) message_ = done.error().message;
    };
    if (input.pressed(key::kF1 + 8)) say(toggleVideo());
    if (input.pressed(key::kF1 + 11)) say(takePicture());
}

bool Viewer::handle(const InputEvents& input, bool& recreate) {
    if (input.size.x <= 0 || input.size.y <= 0) return false;
    const Manipulator::Asks asks = hand_.take(input, cameraOf(draft_.camera, session_->bounds()), *session_, draft_);
    edited_ = edited_ || asks.edited;
    recreate = recreate || asks.recreate;
    return asks.mouse;
}

void Viewer::closeTopmost() {
    if (saving_)
        saving_ = false;
    else if (browser_.shown())
        browser_.show(false);
    else
        showHelp_ = false;
}

// The first time the world is made anew, with the same water.
void Viewer::turnBrush() {
    if (!brush_.on() && !draft_.flow.empty() && draft_.fluid.blocks.empty() && draft_.emitters.empty()) {
        message_ = "this scene's water is on its skin alone: a click on the skin is a drop";
        return;
    }
    if (session_->replaying() != nullptr) {
        message_ = "replaying: what was recorded is shown; run the scene without --replay to pour water in";
        return;
    }
    brush_.turn(!brush_.on());
    if (!brush_.on() || draft_.pour.litres > 0) return;
    draft_.pour.litres = litresToPour(draft_.fluid, session_->world().particles().count);
    anew_ = true;
}

void Viewer::moveCamera(const InputEvents& input) {
    vec2 size(std::max(input.size.x, 1), std::max(input.size.y, 1));
    vec2 moved = input.mouseDelta / size.y;
    bool turns = input.down(MouseButton::left), pans = input.down(MouseButton::right) || input.down(MouseButton::middle);
    // What the mouse did before it was pressed is no drag.
    const bool pressed = input.pressed(MouseButton::left) || input.pressed(MouseButton::right) || input.pressed(MouseButton::middle);
    bool any = (turns || pans) && !pressed && moved != vec2(0.0F);
    if (!any) turns = pans = false;
    if (!any && input.wheel.y == 0) return;
    Camera camera = cameraOf(draft_.camera, session_->bounds());
    OrbitCamera orbit = OrbitCamera::from(camera);
    constexpr float kDegreesAcross = 200;  // of a drag over the window's height
    if (turns) orbit.orbit(-kDegreesAcross * moved.x, kDegreesAcross * moved.y);
    if (pans && !turns) {
        float across = 2 * std::tan(0.5F * camera.fieldOfView * kPi / 180.0F);  // in distances: the point under the mouse stays under it
        orbit.pan(-across * moved.x, across * moved.y);
    }
    if (input.wheel.y != 0) orbit.zoom(input.wheel.y);
    constexpr float kNearest = 1e-3F, kFarthest = 1e4F;  // m
    orbit.distance = std::clamp(orbit.distance, kNearest, kFarthest);
    orbit.apply(camera);
    if (!isFinite(camera.position) || !isFinite(camera.target)) return;
    draft_.camera.position = camera.position;
    draft_.camera.target = camera.target;
    edited_ = true;
}

void Viewer::touch(const InputEvents& input) {
    constexpr int kLeft = static_cast<int>(MouseButton::left);
    constexpr float kStill = 4;  // px: what moved further was a drag
    if (input.buttonPressed[kLeft]) pressedAt_ = input.mouse;
    if (!input.buttonReleased[kLeft] || glm::distance(input.mouse, pressedAt_) > kStill || session_->flows().empty()) return;
    if (input.size.x <= 0 || input.size.y <= 0) return;
    const ViewRay ray = rayThrough(cameraOf(draft_.camera, session_->bounds()), input.mouse, vec2(input.size));
    constexpr uint32_t kTear = 8000000;  // picolitres
    session_->flows().drip(dvec3(ray.origin), dvec3(ray.direction), kTear);
}

// A button for each of the scene's presets.
bool Viewer::drawPresets() {
    bool chosen = false;
    const float right = ImGui::GetWindowPos().x + ImGui::GetWindowContentRegionMax().x;
    for (size_t k = 0; k < draft_.presets.size(); ++k) {
        const PresetParams& preset = draft_.presets[k];
        const float wide = ImGui::CalcTextSize(preset.name.c_str()).x + 2 * ImGui::GetStyle().FramePadding.x;
        if (k > 0 && ImGui::GetItemRectMax().x + ImGui::GetStyle().ItemSpacing.x + wide < right) ImGui::SameLine();
        if (ImGui::Button(fmt::format("{}###preset{}", preset.name, k).c_str())) {
            if (Status set = applyPreset(draft_, preset.name); !set) message_ = set.error().message;
            chosen = true;
            break;
        }
        if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", preset.doc.c_str());
    }
    return chosen;
}

bool Viewer::drawPanels() {
    if (!ImGui::IsAnyItemActive() && !(opening_ && !opening_->other)) settled_ = session_->scene();
    ImVec2 display = ImGui::GetIO().DisplaySize;
    constexpr float kMargin = 10;
    const float half = std::max(0.5F * (display.x - 3 * kMargin), 160.0F);
    float width = std::min(std::clamp(display.x * 0.26F, 320.0F, 420.0F), half), tall = std::max(display.y - 2 * kMargin, 80.0F);
    if (vec2(display.x, display.y) != laidOutFor_) {  // wherever it was put, it would be in another window
        laidOutFor_ = vec2(display.x, display.y);
        ImGui::SetNextWindowPos(ImVec2(kMargin, kMargin), ImGuiCond_Always);
        ImGui::SetNextWindowSize(ImVec2(width, tall), ImGuiCond_Always);
    }
    bool recreate = false;
    if (ImGui::Begin(fmt::format("{}###scene", draft_.name).c_str())) {
        const DeviceInfo& device = device_->info();
        FluidPanelState state;
        state.paused = paused_;
        state.filming = video_.has_value();
        state.pouring = brush_.on();
        state.backend = fmt::format("{}: {}", backendName(device_->backend()), device.name);
        state.renderer = gl_.renderer;
        state.transfer = sentenceOf(upload_.facts());
        for (const PlanRow& row : plans().rows)
            if (row.plan == work_->plan()) state.plan = fmt::format("{}: {}", row.name, row.doc);
        state.simulateMs = profiler_.mean("simulate");
        state.frameMs = profiler_.meanFrame();
        state.message = message_;
        if (session_->replaying() != nullptr) state.replay = session_->replaying()->sentence();
        const std::vector<std::string> notices = notices_->all();
        state.notices = notices;
        FluidPanelActions actions = drawFluidPanel(session_->world(), state);
        if (actions.togglePause) paused_ = !paused_;
        if (actions.step) paused_ = stepOnce_ = true;
        if (actions.reset) session_->reset();
        if (actions.help) showHelp_ = !showHelp_;
        if (actions.scenes) browser_.show(!browser_.shown());
        if (actions.save) saving_ = true;
        if (actions.pour) turnBrush();
        if (actions.dismiss) notices_->forget(*actions.dismiss);
        const Status taken = actions.picture ? takePicture() : actions.video ? toggleVideo() : ok();
        if (!taken) message_ = taken.error().message;
        ImGui::Spacing();
        if (!draft_.presets.empty()) {
            if (drawPresets()) {
                edited_ = true;
                SceneFile now = session_->scene();
                if (session_->budget()) now.fluid = draft_.fluid;
                recreate = fixedValues(visiting(now)) != fixedValues(visiting(draft_));
            }
            ImGui::Spacing();
        }
        const TreeAsks asks = drawSceneTree(*session_, draft_, hand_);
        edited_ = edited_ || asks.edited;
        if (!asks.find.empty()) params_.wanted = asks.find;
        ParamPanel panel(params_);
        panel.search(visiting(draft_));
        constexpr float kLeast = 12;  // lines, and the panel is scrolled
        ImGui::BeginChild("parameters", ImVec2(0, std::max(ImGui::GetContentRegionAvail().y, kLeast * ImGui::GetFontSize())));
        draft_.visit(panel);
        ImGui::EndChild();
        edited_ = edited_ || panel.changed();
        recreate = panel.recreate() || recreate;
    }
    ImGui::End();

    const float room = display.x - width - 3 * kMargin;
    if (watch_.draw(*session_, *renderer_, timeline_, profiler_, draft_, kMargin, room)) recreate = edited_ = true;
    return recreate;
}

Status Viewer::step(double seconds) {
    constexpr double kStep = 1.0 / kFramesPerSecond;  // on the wall
    const double simulated = session_->scene().timeScale;
    waiting_ = std::min(waiting_ + std::max(seconds, 0.0), 2 * kStep);
    bool due = waiting_ >= kStep;
    if (due) waiting_ -= kStep;
    // With fixed steps the world keeps what is left over of frames, and shows what is between: it is told of each frame as it comes.
    const bool fixed = session_->scene().fluid.fixedStep > 0 && !stepOnce_ && session_->replaying() == nullptr;
    if (fixed) {
        due = seconds > 0;
        waiting_ = 0;
    }
    if ((paused_ || !due) && !stepOnce_) return ok();
    stepOnce_ = false;
    due_ = simulated * (fixed ? seconds : kStep);
    if (work_->plan() == Plan::behind) return ok();  // while it is drawn
    if (!work_->started() || fixed) {                // what was found ahead is of a step as long as the last
        work_->drop();
        return stepped(work_->step(due_, false, deviceMs_), seconds);
    }
    return stepped(work_->finish(), seconds);
}

void Viewer::begin() {
    work_ = std::make_unique<Cooperation>(*session_, plan_, &timeline_, log_);
    due_ = 0;
}

// `seconds`: on the wall, of the frame.
Status Viewer::stepped(double ms, double seconds) {
    ++steps_;
    stepShown_ = true;
    const Result<bool> moved = keepRunning(*session_, device_, log_);
    if (!moved) return moved.error();
    if (*moved) {
        traceKernels(*device_, timeline_);
        draft_.fluid.grid = session_->scene().fluid.grid;  // the cpu may not know it
        if (recorder_) recorder_->follow(session_->world());
    }
    if (told_)
        if (Status heard = told_(*session_); !heard) return heard;
    if (const int repicked = session_->budget() ? session_->budget()->repicked() : 0; repicked != repicked_) {
        repicked_ = repicked;
        draft_.fluid = session_->scene().fluid;  // what the panel shows
    }
    std::vector<PassTime> passes = device_->takeTimes();
    deviceMs_ = 0;
    for (const PassTime& pass : passes) deviceMs_ += pass.ms;
    profiler_.add("simulate", passes);
    watch_.stepped(*session_, std::max(ms, deviceMs_));
    if (!recorder_) return ok();
    recorder_->stepped(ms, passes);
    recorder_->drawn(0, 1000 * seconds, renderer_->times());
    return ok();
}

Status Viewer::settle() {
    if (work_->plan() == Plan::behind && work_->started()) return stepped(work_->finish(), 0);
    work_->drop();
    return ok();
}

void Viewer::record() { recorder_.emplace(session_->world(), session_->fields(), true, &session_->flows()); }

const Timeline& Viewer::wholeTimeline() {
    renderer_->finish();
    device_->finish();
    (void)device_->takeTimes();
    return timeline_;
}

RunStats Viewer::finishRecord() {
    ASSERT(recorder_, "record() comes first");
    work_->drop();
    (void)wholeTimeline();
    RunStats stats = recorder_->finish(session_->scene().name);
    stats.cooperation = work_->stats();
    stats.cooperation.tried = tried_;
    return stats;
}

// `uploaded` is called when nothing more is read of the world.
Status Viewer::drawWater(Session& session, int width, int height, const std::function<void()>& uploaded) {
    const SceneFile& scene = session.scene();
    std::optional<TimedSpan> span(std::in_place, &timeline_, "main", "upload");
    Result<FluidView> fluid = viewOf(upload_, session);
    if (!fluid) return fluid.error();
    if (Status wet = session.flows().draw(); !wet) return wet;
    Camera camera = cameraOf(scene.camera, session.bounds());
    FrameView view = frameViewOf(camera, scene.light, width, height, session.time());
    span.reset();
    uploaded();
    const TimedSpan drawing(&timeline_, "main", "draw");
    return renderer_->draw(view, *fluid, session.solids(), scene);
}

void Viewer::drawUi() {
    const double began = threadSeconds();
    ui_.draw();
    panelCost_.told = 1000 * (threadSeconds() - began);
}

Status Viewer::draw(const InputEvents& input, GLuint framebuffer) {
    int width = input.framebuffer.x, height = input.framebuffer.y;
    const auto stepOn = [this] {
        const bool behind = work_->plan() == Plan::behind && steps_ < mostSteps_;
        if (due_ > 0 && (behind || (work_->plan() == Plan::thesis && !paused_))) work_->start(due_, false, deviceMs_);
        due_ = 0;
    };
    if (width <= 0 || height <= 0) {
        stepOn();
        drawUi();  // ends ImGui's frame; it draws nothing
        return ok();
    }
    const SceneFile& scene = session_->scene();
    if (Status drawn = drawWater(*session_, width, height, stepOn); !drawn) {
        if (!reload_.broken()) return drawn;
        message_ = drawn.error().message;  // a program that is wanted for the first time: the last picture stays
    }
    if (recorder_) recorder_->transferred(upload_.facts());
    if (Status filmed = film(); !filmed) {
        video_.reset();
        message_ = filmed.error().message;
    }
    renderer_->present(framebuffer, width, height);

    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    glViewport(0, 0, width, height);
    uiTimer_.begin(0);
    drawUi();
    uiTimer_.end();
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    uiTimer_.collect([this](uint64_t, const gpu::Timer::Times& times) { uiMs_ = times.ms(); });
    profiler_.add("render", renderer_->times());
    if (renderer_->times().empty()) return ok();  // none has come back yet
    const PassTime ui[] = {{.name = "ui", .ms = uiMs_, .calls = 1}};
    profiler_.add("render", ui);
    if (scene.look.split.empty() && scene.look.quality == "auto") {  // a half that is ray-marched says nothing of the other
        double ms = 0;
        for (const PassTime& pass : renderer_->times()) ms += pass.ms;
        adaptiveQuality_.frame(ms);
        renderer_->hurry(adaptiveQuality_.fast());
    }
    return ok();
}

}  // namespace rivulet
