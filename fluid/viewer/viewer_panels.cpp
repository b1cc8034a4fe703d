// The windows over a Viewer's picture: the scene's panel at the left, the inspector at the right, dialogs and messages.
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "fluid/viewer/scene_tree.h"
#include "fluid/viewer/viewer.h"

namespace rivulet {

void Viewer::drawPanels() {
    if (!showPanels_) return watch_.hide(picture_.renderer());
    if (!ImGui::IsAnyItemActive() && !opener_.edits()) draft_.settled = scene();
    ImVec2 display = ImGui::GetIO().DisplaySize;
    constexpr float kMargin = 10;
    const float half = std::max(0.5F * (display.x - 3 * kMargin), 160.0F);
    float width = std::min(std::clamp(display.x * 0.26F, 320.0F, 420.0F), half), tall = std::max(display.y - 2 * kMargin, 80.0F);
    if (vec2(display.x, display.y) != laidOutFor_) {  // wherever it was put, it would be in another window
        laidOutFor_ = vec2(display.x, display.y);
        ImGui::SetNextWindowPos(ImVec2(kMargin, kMargin), ImGuiCond_Always);
        ImGui::SetNextWindowSize(ImVec2(width, tall), ImGuiCond_Always);
    }
    if (ImGui::Begin(fmt::format("{}###scene", draft_.scene.name).c_str())) drawScenePanel();
    ImGui::End();

    const float room = display.x - width - 3 * kMargin;
    if (watch_.draw(session(), picture_.renderer(), run_.timeline(), profiler_, draft_.scene, kMargin, room)) anew_ = edited_ = true;
}

FluidPanelState Viewer::panelState() const {
    const Device& device = run_.device();
    FluidPanelState state;
    state.paused = run_.paused();
    state.filming = capture_.filming();
    state.pouring = brush_.on();
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
    if (!draft_.scene.presets.empty()) {
        drawPresets();
        ImGui::Spacing();
    }
    const TreeAsks asks = drawSceneTree(session(), draft_.scene, hand_);
    edited_ = edited_ || asks.edited;
    if (!asks.find.empty()) draft_.params.wanted = asks.find;
    ParamPanel panel(draft_.params);
    panel.search(visiting(draft_.scene));
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

void Viewer::drawDialogs(const InputEvents& input, double seconds) {
    if (!showPanels_) {
        std::string text = message_;
        for (const std::string& notice : notices_->all()) text += (text.empty() ? "" : "\n") + notice;
        messageBar_.draw(std::move(text), seconds, !reload_.message().empty());
    }
    if (showHelp_) drawKeyHelp();
    if (opening() != nullptr && SceneOpener::drawProgress(*opening(), 0.86F)) giveUpOpening();
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
    if (session().replaying() != nullptr) return browser_.refuse("replaying a recording: run the scene without --replay to open another");
    Result<SceneFile> scene = loadScene(fullPath(*path), {});
    if (!scene) return browser_.refuse(scene.error().message);
    browser_.show(false);
    open(std::move(*scene));
}

}  // namespace rivulet
