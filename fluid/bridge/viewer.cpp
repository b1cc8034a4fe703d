#include "fluid/bridge/viewer.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "engine/ui/param_panel.h"
#include "fluid/bridge/takeover.h"

namespace rivulet {

namespace {

void drawHelp() {
    ImVec2 display = ImGui::GetIO().DisplaySize;
    constexpr struct {
        const char* key;
        const char* does;
    } kKeys[] = {{"left drag", "turn the view"},   {"right or middle drag", "move the view"},
                 {"wheel", "nearer, farther"},     {"space", "pause, go on"},
                 {"period", "one step"},           {"R", "start again"},
                 {"Tab", "show, hide the panels"}, {"H", "show, hide this"},
                 {"click", "a drop, on a skin"}};
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

Result<std::unique_ptr<Viewer>> Viewer::create(const SceneFile& scene, const ViewerOptions& options, const Log& log) {
    Result<UiLayer> ui = UiLayer::create(options.clipboard);
    if (!ui) return ui.error();
    std::unique_ptr<Viewer> viewer(new Viewer(std::move(*ui)));
    Viewer& v = *viewer;
    // What is said to the person at the program is said in the panel too.
    v.log_.sink = [log, kept = v.notices_](LogLevel level, std::string_view text) {
        const std::lock_guard<std::mutex> lock(kept->mutex);
        if (log.sink) log.sink(level, text);
        constexpr size_t kMost = 4;
        if (level < LogLevel::notice) return;
        if (kept->sentences.size() == kMost) kept->sentences.erase(kept->sentences.begin());
        kept->sentences.emplace_back(text);
    };
    v.gl_ = currentGlFacts();
    const auto surroundings = surroundingsOf(scene);
    if (!surroundings) return surroundings.error();
    auto renderer = SceneRenderer::create(ShaderFiles::developer(), *surroundings ? &**surroundings : nullptr);
    if (!renderer) return renderer.error();
    v.renderer_ = std::move(*renderer);
    std::string backend = options.backend;
    if (options.cooperate == "auto") {
        const auto draw = [&](Session& session, const std::function<void()>& uploaded, std::vector<PassTime>& passes) -> Status {
            if (Status drawn = v.drawWater(session, options.width, options.height, uploaded); !drawn) return drawn;
            v.renderer_->finish();
            passes = v.renderer_->times();
            return ok();
        };
        Result<std::vector<PlanTried>> tried = tryPlans(scene, v.gl_, draw, v.log_, 6, options.device);
        if (!tried) return tried.error();
        v.log_.notice(sentenceOf(*tried, backend));
        backend = tried->front().backend;
        v.plan_ = tried->front().plan;
    } else {
        v.plan_ = plans().find(options.cooperate)->plan;
    }
    v.device_ = makeDevice(backend, v.gl_, v.log_, options.device);
    auto opened = openSession(scene, *v.device_, v.log_);
    if (!opened) return opened.error();
    if (opened->instead) v.device_ = std::move(opened->instead);
    v.session_ = std::move(opened->session);
    traceKernels(*v.device_, v.timeline_);
    v.renderer_->onSpan(v.timeline_.lane(kDrawingLane));
    v.begin();
    v.draft_ = v.session_->scene();
    v.haste_.begin(v.gl_.software);
    v.renderer_->hurry(v.haste_.fast());
    return viewer;
}

Status Viewer::frame(const InputEvents& input, double seconds, GLuint framebuffer) {
    edited_ = false;
    if (work_->plan() == Plan::behind && work_->started())
        if (Status done = stepped(work_->finish(), seconds); !done) return done;
    ui_.begin(input, seconds);
    if (!ui_.wantsKeyboard()) takeKeys(input);
    bool recreate = showPanels_ && drawPanels();
    if (showHelp_) drawHelp();
    if (!ui_.wantsMouse()) {
        moveCamera(input);
        touch(input);
    }
    if (edited_ || recreate) takeEdits(recreate);
    if (Status stepped = step(seconds); !stepped) return stepped;
    Status drawn = draw(input, framebuffer);
    profiler_.endFrame(1000 * seconds);
    return drawn;
}

void Viewer::takeKeys(const InputEvents& input) {
    if (input.pressed(GLFW_KEY_SPACE)) paused_ = !paused_;
    if (input.pressed(GLFW_KEY_PERIOD)) paused_ = stepOnce_ = true;
    if (input.pressed(GLFW_KEY_R)) session_->reset();
    if (input.pressed(GLFW_KEY_TAB)) showPanels_ = !showPanels_;
    if (input.pressed(GLFW_KEY_H)) showHelp_ = !showHelp_;
}

void Viewer::moveCamera(const InputEvents& input) {
    vec2 size(std::max(input.size.x, 1), std::max(input.size.y, 1));
    vec2 moved = input.mouseDelta / size.y;
    bool turns = input.down(MouseButton::left), pans = input.down(MouseButton::right) || input.down(MouseButton::middle);
    bool any = (turns || pans) && moved != vec2(0.0F);
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
    const Camera camera = cameraOf(draft_.camera, session_->bounds());
    const vec2 size(input.size);
    const mat4 back = glm::inverse(camera.projection(size.x / size.y) * camera.view());
    const vec2 at(2 * input.mouse.x / size.x - 1, 1 - 2 * input.mouse.y / size.y);
    const vec4 far = back * vec4(at, 1.0F, 1.0F);
    constexpr uint32_t kTear = 8000000;  // picolitres
    session_->flows().drip(dvec3(camera.position), dvec3(vec3(far) / far.w - camera.position), kTear);
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
    if (!ImGui::IsAnyItemActive()) settled_ = session_->scene();
    ImVec2 display = ImGui::GetIO().DisplaySize;
    constexpr float kMargin = 10;
    float width = std::clamp(display.x * 0.26F, 320.0F, 420.0F), tall = std::max(display.y - 2 * kMargin, 80.0F);
    ImGui::SetNextWindowPos(ImVec2(kMargin, kMargin), ImGuiCond_Once);
    ImGui::SetNextWindowSize(ImVec2(width, tall), ImGuiCond_Once);
    bool recreate = false;
    if (ImGui::Begin(fmt::format("{}###scene", draft_.name).c_str())) {
        const DeviceInfo& device = device_->info();
        FluidPanelState state;
        state.paused = paused_;
        state.backend = fmt::format("{}: {}", backendName(device_->backend()), device.name);
        state.renderer = gl_.renderer;
        const TransferFacts& transfer = upload_.facts();
        state.transfer = transfer.bytes > 0 ? fmt::format("{}: {:.2f} ms, {:.1f} MB{}", transfer.way, transfer.ms,
                                                          1.0e-6 * static_cast<double>(transfer.bytes),
                                                          transfer.waits > 0 ? fmt::format(", waited {} times", transfer.waits) : "")
                                            : transfer.way;
        for (const PlanRow& row : plans().rows)
            if (row.plan == work_->plan()) state.plan = fmt::format("{}: {}", row.name, row.doc);
        state.simulateMs = profiler_.mean("simulate");
        state.frameMs = profiler_.meanFrame();
        state.message = message_;
        {
            const std::lock_guard<std::mutex> lock(notices_->mutex);
            state.notices = notices_->sentences;
        }
        FluidPanelActions actions = drawFluidPanel(session_->world(), state);
        if (actions.togglePause) paused_ = !paused_;
        if (actions.step) paused_ = stepOnce_ = true;
        if (actions.reset) session_->reset();
        if (actions.help) showHelp_ = !showHelp_;
        ImGui::Spacing();
        if (!draft_.presets.empty()) {
            edited_ = drawPresets() || edited_;
            ImGui::Spacing();
        }
        ImGui::BeginChild("parameters");
        ParamPanel panel;
        draft_.visit(panel);
        ImGui::EndChild();
        edited_ = edited_ || panel.changed();
        recreate = panel.recreate();
    }
    ImGui::End();

    ImGui::SetNextWindowPos(ImVec2(display.x - kMargin, kMargin), ImGuiCond_Once, ImVec2(1, 0));
    float narrow = std::min(width, 320.0F);
    ImGui::SetNextWindowSizeConstraints(ImVec2(narrow, 0), ImVec2(narrow, tall));
    if (ImGui::Begin("times", nullptr, ImGuiWindowFlags_AlwaysAutoResize)) {
        const float across = narrow - 2 * ImGui::GetStyle().WindowPadding.x;
        timelinePanel_.draw(timeline_, 1.0e-3 * profiler_.meanFrame(), across);
        ImGui::Spacing();
        profiler_.draw(across);
        ImGui::Spacing();
        voxels_.draw(session_->fields(), session_->world().time(), std::min(across, ImGui::GetContentRegionAvail().x));
    }
    ImGui::End();
    return recreate;
}

// An edit that makes no sense is refused with a sentence, and the last good scene stays.
void Viewer::takeEdits(bool recreate) {
    Status sense = checkScene(draft_);
    if (!sense && !recreate) {
        message_ = sense.error().message;  // a drag may pass through it: the draft stays as it is
        return;
    }
    recreate = recreate || session_->needsNew(draft_);
    if (!recreate) {
        message_.clear();
        session_->apply(draft_);
        if (session_->budget()) draft_.fluid = session_->scene().fluid;  // what a budget holds, an edit does not change
        return;
    }
    {
        const std::lock_guard<std::mutex> lock(notices_->mutex);
        notices_->sentences.clear();
    }
    Result<OpenedSession> fresh = sense ? openSession(draft_, *device_, log_) : Result<OpenedSession>(sense.error());
    if (fresh) {
        work_.reset();
        session_ = std::move(fresh->session);
        if (fresh->instead) {  // nothing is on the other any more
            device_ = std::move(fresh->instead);
            traceKernels(*device_, timeline_);
        }
        begin();
        draft_ = session_->scene();  // a budget may have picked
        repicked_ = 0;
        message_.clear();
        profiler_.clear();
        voxels_.clear();
        if (recorder_) record();
    } else {
        message_ = fresh.error().message;
        session_->apply(settled_);  // a drag has gone through it
        draft_ = session_->scene();
    }
}

Status Viewer::step(double seconds) {
    constexpr double kStep = 1.0 / kFramesPerSecond;  // on the wall
    const double simulated = session_->scene().timeScale;
    waiting_ = std::min(waiting_ + std::max(seconds, 0.0), 2 * kStep);
    bool due = waiting_ >= kStep;
    if (due) waiting_ -= kStep;
    // With fixed steps the world keeps what is left over of frames, and shows what is between: it is told of each frame as it comes.
    const bool fixed = session_->scene().fluid.fixedStep > 0 && !stepOnce_;
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
        work_->start(due_, false, deviceMs_);
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
    const Result<bool> moved = keepRunning(*session_, device_, log_);
    if (!moved) return moved.error();
    if (*moved) traceKernels(*device_, timeline_);
    if (*moved && recorder_) recorder_->follow(session_->world());
    if (const int repicked = session_->budget() ? session_->budget()->repicked() : 0; repicked != repicked_) {
        repicked_ = repicked;
        draft_.fluid = session_->scene().fluid;  // what the panel shows
    }
    std::vector<PassTime> passes = device_->takeTimes();
    deviceMs_ = 0;
    for (const PassTime& pass : passes) deviceMs_ += pass.ms;
    profiler_.add("simulate", passes);
    if (!recorder_) return ok();
    recorder_->stepped(ms, passes);
    recorder_->drawn(0, 1000 * seconds, renderer_->times());
    return ok();
}

void Viewer::record() { recorder_.emplace(session_->world(), session_->fields(), true, &session_->flows()); }

RunStats Viewer::finishRecord() {
    ASSERT(recorder_, "record() comes first");
    work_->drop();
    RunStats stats = recorder_->finish(session_->scene().name);
    stats.cooperation = work_->stats();
    return stats;
}

// `uploaded` is called when nothing more is read of the world.
Status Viewer::drawWater(Session& session, int width, int height, const std::function<void()>& uploaded) {
    const SceneFile& scene = session.scene();
    std::optional<TimedSpan> span(std::in_place, &timeline_, "main", "upload");
    Result<FluidView> fluid = upload_.view(session.world(), scene.look, session.flows().airDrops());
    if (!fluid) return fluid.error();
    if (Status wet = session.flows().draw(); !wet) return wet;
    Camera camera = cameraOf(scene.camera, session.bounds());
    FrameView view = frameViewOf(camera, scene.light, width, height, session.world().time());
    span.reset();
    uploaded();
    const TimedSpan drawing(&timeline_, "main", "draw");
    return renderer_->draw(view, *fluid, session.solids(), scene);
}

Status Viewer::draw(const InputEvents& input, GLuint framebuffer) {
    int width = input.framebuffer.x, height = input.framebuffer.y;
    const auto stepOn = [this] {
        const bool behind = work_->plan() == Plan::behind;
        if (due_ > 0 && (behind || (work_->plan() == Plan::thesis && !paused_))) work_->start(due_, false, deviceMs_);
        due_ = 0;
    };
    if (width <= 0 || height <= 0) {
        stepOn();
        ui_.draw();  // ends ImGui's frame; it draws nothing
        return ok();
    }
    const SceneFile& scene = session_->scene();
    if (Status drawn = drawWater(*session_, width, height, stepOn); !drawn) return drawn;
    if (recorder_) recorder_->transferred(upload_.facts());
    renderer_->present(framebuffer, width, height);

    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    glViewport(0, 0, width, height);
    uiTimer_.begin(0);
    ui_.draw();
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
        haste_.frame(ms);
        renderer_->hurry(haste_.fast());
    }
    return ok();
}

}  // namespace rivulet
