// The windows over a Viewer's picture: the scene's panel at the left, the inspector at the right, dialogs and messages.
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "fluid/viewer/scene_sliders.h"
#include "fluid/viewer/scene_tree.h"
#include "fluid/viewer/viewer.h"

namespace rivulet {

void Viewer::drawPanels() {
    panelRight_ = 0;
    if (!showPanels_) return watch_.hide(picture_.renderer());
    if (!ImGui::IsAnyItemActive() && !opener_.edits()) draft_.settled = scene();
    ImVec2 display = ImGui::GetIO().DisplaySize;
    constexpr float kMargin = 10;
    const float half = std::max(0.5F * (display.x - 3 * kMargin), 160.0F);
    float width = std::min(std::clamp(display.x * 0.242F, 310.0F, 420.0F), half), tall = std::max(display.y - 2 * kMargin, 80.0F);
    if (vec2(display.x, display.y) != laidOutFor_) {  // wherever it was put, it would be in another window
        laidOutFor_ = vec2(display.x, display.y);
        ImGui::SetNextWindowPos(ImVec2(kMargin, kMargin), ImGuiCond_Always);
        ImGui::SetNextWindowSize(ImVec2(width, tall), ImGuiCond_Always);
    }
    if (ImGui::Begin(fmt::format("{}###scene", draft_.scene.name).c_str())) drawScenePanel();
    ImGui::End();

    const float room = display.x - width - 3 * kMargin;
    panelRight_ = width + 2 * kMargin;
    drawTimeline(panelRight_, display.x - kMargin);
    if (watch_.draw(session(), picture_.renderer(), run_.timeline(), profiler_, draft_.scene, kMargin, room)) anew_ = edited_ = true;
}

FluidPanelState Viewer::panelState() const {
    const Device& device = run_.device();
    FluidPanelState state;
    state.paused = run_.paused();
    state.filming = capture_.filming();
    state.pouring = brush_.on();
    state.recording = recording_.recording();
    state.measuring = watch_.visible();
    const ScenePicture::Quality quality = picture_.quality(scene().look);
    state.quality = quality.name;
    state.why = quality.why;
    state.backend = fmt::format("{}: {}", backendName(device.backend()), device.info().name);
    state.renderer = gl_.renderer;
    state.transfer = sentenceOf(picture_.facts());
    for (const PlanRow& row : plans().rows)
        if (row.plan == run_.plan()) state.plan = fmt::format("{}: {}", row.name, row.doc);
    state.simulateMs = profiler_.mean("simulate");
    state.frameMs = profiler_.meanFrame();
    state.message = message_;
    if (session().replaying() != nullptr) state.replay = session().replaying()->sentence();
    return state;
}

void Viewer::drawScenePanel() {
    FluidPanelState state = panelState();
    const std::vector<std::string> notices = notices_->all();
    state.notices = notices;
    const FluidPanelActions actions = drawFluidPanel(session().world(), state);
    run(actions.command);
    if (actions.dismiss) notices_->forget(*actions.dismiss);
    ImGui::Spacing();
    ParamPanel panel(draft_.params);
    panel.search(visiting(draft_.scene));  // above what differs from scene to scene
    if (!draft_.scene.presets.empty()) drawPresets();
    edited_ = drawSceneSliders(draft_.scene) || edited_;
    const TreeAsks asks = drawSceneTree(session(), draft_.scene, hand_);
    edited_ = edited_ || asks.edited;
    if (!asks.find.empty()) draft_.params.wanted = asks.find;
    constexpr float kLeast = 12;  // lines, and the panel is scrolled
    ImGui::BeginChild("parameters", ImVec2(0, std::max(ImGui::GetContentRegionAvail().y, kLeast * ImGui::GetFontSize())));
    draft_.scene.visit(panel);
    ImGui::EndChild();
    edited_ = edited_ || panel.changed();
    anew_ = anew_ || panel.recreate();
}

// A button for each of the scene's presets.
void Viewer::drawPresets() {
    const float right = ImGui::GetWindowPos().x + ImGui::GetWindowContentRegionMax().x;
    for (size_t k = 0; k < draft_.scene.presets.size(); ++k) {
        const PresetParams& preset = draft_.scene.presets[k];
        const float wide = ImGui::CalcTextSize(preset.name.c_str()).x + 2 * ImGui::GetStyle().FramePadding.x;
        if (k > 0 && ImGui::GetItemRectMax().x + ImGui::GetStyle().ItemSpacing.x + wide < right) ImGui::SameLine();
        if (ImGui::Button(fmt::format("{}###preset{}", preset.name, k).c_str())) {
            report(applyPreset(draft_.scene, preset.name));
            edited_ = true;
            SceneFile now = scene();
            if (session().budget()) now.fluid = draft_.scene.fluid;
            anew_ = anew_ || fixedValues(visiting(now)) != fixedValues(visiting(draft_.scene));
            return;
        }
        if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", preset.doc.c_str());
    }
}

void Viewer::drawTimeline(float left, float right) {
    const SceneRecording::Asked asked = recording_.drawTimeline(session(), left, right);
    switch (asked.ask) {
        case SceneRecording::Ask::none:
            return;
        case SceneRecording::Ask::stop:
            return run(Command::record);
        case SceneRecording::Ask::replay:
            return replay(0, true);
        case SceneRecording::Ask::simulate:
            return simulate();
        case SceneRecording::Ask::scrub:
            return replay(asked.frame, false);
    }
}

// Asks before a change that makes frames slow. Beside the panel: a click meant for a slider is no answer.
void Viewer::drawCost() {
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos(ImVec2(0.5F * (panelRight_ + display.x), display.y / 2), ImGuiCond_Always, ImVec2(0.5F, 0.5F));
    ImGui::SetNextWindowSize(ImVec2(std::min(26 * ImGui::GetFontSize(), display.x - panelRight_), 0), ImGuiCond_Always);
    ImGui::SetNextWindowBgAlpha(1);
    ImGui::Begin("cost", nullptr, ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings);
    ImGui::TextWrapped("%s", waiting_->sentence.c_str());
    ImGui::Spacing();
    const bool change = ImGui::Button("change anyway");
    ImGui::SameLine();
    const bool keep = ImGui::Button("keep the present value");
    ImGui::End();
    if (!change && !keep) return;
    Waiting waiting = std::move(*waiting_);
    waiting_.reset();
    if (!change) return refuse({}, Cause::edit, waiting.before);
    if (waiting.opened.session) return adoptEdit(std::move(waiting.opened), std::move(waiting.made));
    accepted_ = true;
    startOpening(std::move(waiting.made), Cause::edit);
}

void Viewer::drawDialogs(const InputEvents& input, double seconds) {
    if (!showPanels_) {
        std::string text = message_;
        for (const std::string& notice : notices_->all()) text += (text.empty() ? "" : "\n") + notice;
        messageBar_.draw(std::move(text), seconds, !reload_.message().empty());
    }
    if (showHelp_) drawKeyHelp();
    if (waiting_) drawCost();
    if (opening() != nullptr && SceneOpener::drawProgress(*opening(), 0.86F, panelRight_)) giveUpOpening();
    reload_.draw();
    if (save_.shown())
        if (const std::optional<std::string> path = save_.draw(draft_.scene)) saved(*path);
    if (browser_.shown()) chooseScene();
    welcomeScreen_.draw(input);
}

void Viewer::saved(const std::string& path) {
    SceneFile& scene = draft_.scene;
    draft_.saved = SceneDraft::textOf(scene, session().budget().has_value());
    std::error_code error;
    if (std::filesystem::equivalent(path, scene.source.path, error)) {  // from now on the file alone says what the scene is
        scene.source = {scene.source.path, {}, {}};
        reload_.follow(scene);
    }
    log_.notice(fmt::format("scene saved: {}", std::filesystem::absolute(path, error).string()));
}

void Viewer::chooseScene() {
    const std::optional<std::string> path = browser_.draw();
    if (!path) return;
    if (session().replaying() != nullptr) return browser_.refuse(kReplayed);
    Result<SceneFile> scene = loadScene(fullPath(*path), {});
    if (!scene) return browser_.refuse(scene.error().message);
    browser_.show(false);
    open(std::move(*scene));
}

}  // namespace rivulet
