// HotReload: detects written files, applies or refuses them, and shows a message.
#include "fluid/viewer/hot_reload.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "engine/core/message_line.h"
#include "engine/core/param_list.h"
#include "engine/ui/style.h"

namespace rivulet {

namespace {

bool sameCamera(const CameraParams& a, const CameraParams& b) {
    return a.from == b.from && a.position == b.position && a.target == b.target && a.fieldOfView == b.fieldOfView;
}

// Values edited since the file was `before` stay in `written`, unless the file changed them.
void keepEdits(SceneFile before, SceneFile shown, SceneFile& written) {
    const auto visiting = [](SceneFile& scene) { return [&scene](ParamVisitor& v) { scene.visit(v); }; };
    const std::map<std::string, std::string> was = paramTexts(visiting(before)), is = paramTexts(visiting(written));
    const bool picks = written.budget.frameMs > 0;  // then what is shown of the fluid is no person's
    for (const ParamEntry& entry : listParams(visiting(shown))) {
        const std::string& path = entry.path;
        if (entry.kind != ParamEntry::Kind::value || path.find("[]") != std::string::npos) continue;
        if (path.starts_with("camera.") || (picks && path.starts_with("fluid."))) continue;
        const auto then = was.find(path), now = is.find(path);
        const bool inFile = now != is.end();
        if (then != was.end() && (then->second == entry.text || !inFile || now->second != then->second)) continue;
        if (then == was.end() && inFile) continue;
        if (!setParam(path + "=" + plainText(entry.text), visiting(written))) return;  // a list that the file has shortened
    }
}

bool isKernel(const std::string& path) { return path.ends_with(".kernel"); }

}  // namespace

HotReload::HotReload(const std::string& root) {
    if (!root.empty()) watch_.watch((std::filesystem::path(root) / "shaders").string());
}

void HotReload::follow(const SceneFile& scene) {
    if (!scene_.empty()) watch_.forget(scene_);
    scene_ = scene.source.path;
    if (!scene_.empty()) watch_.watch(scene_);
    read_ = scene;
    sceneTrouble_.clear();
}

std::optional<SceneFile> HotReload::look(double seconds, const SceneFile& shown, SceneRenderer& renderer, Device& device) {
    constexpr double kEvery = 0.2;  // s
    doneFor_ = std::max(doneFor_ - seconds, 0.0);
    waited_ += seconds;
    if (waited_ < kEvery) return std::nullopt;
    waited_ = 0;
    std::vector<std::string> written = watch_.changed();
    const size_t others = std::erase(written, scene_);
    if (!written.empty()) takeShaders(written, renderer, device);
    return others > 0 ? takeScene(shown) : std::nullopt;
}

void HotReload::takeShaders(const std::vector<std::string>& written, SceneRenderer& renderer, Device& device) {
    const Result<size_t> drawn = renderer.reload(), simulated = device.reload();
    shaderTrouble_.clear();
    for (const Result<size_t>* taken : {&drawn, &simulated})
        if (!*taken) shaderTrouble_ += (shaderTrouble_.empty() ? "" : "\n") + shortLog(taken->error().message);
    if (!shaderTrouble_.empty()) return;
    constexpr double kShown = 2;  // s
    const size_t programs = *drawn + *simulated;
    if (programs > 0) {
        done_ = fmt::format("reloaded {} shader{}", programs, programs == 1 ? "" : "s");
        doneFor_ = kShown;
    } else if (device.backend() == Backend::cpu && std::any_of(written.begin(), written.end(), isKernel)) {
        done_ = "the cpu's kernels are compiled into the program: rebuild it, or run with --backend gl";
        doneFor_ = 2 * kShown;
    }
}

std::optional<SceneFile> HotReload::takeScene(const SceneFile& shown) {
    Result<SceneFile> read = loadScene(read_.source.path, read_.source.assignments, read_.source.preset);
    if (!read) {
        sceneTrouble_ = messageLine(read.error().message);
        return std::nullopt;
    }
    sceneTrouble_.clear();
    before_ = std::exchange(read_, *read);
    if (sameCamera(before_.camera, read->camera)) read->camera = shown.camera;
    if (!read->light.from.empty() && read->light.from == shown.light.from) {  // found in a mesh's file, when the scene was opened
        read->light.direction = shown.light.direction;
        read->light.colour = shown.light.colour;
    }
    opened_ = *read;
    keepEdits(before_, shown, *read);
    if (!checkScene(*read)) *read = opened_;  // the two contradict each other: the file is right
    return std::move(*read);
}

std::string HotReload::message() const {
    return shaderTrouble_ + (shaderTrouble_.empty() || sceneTrouble_.empty() ? "" : "\n") + sceneTrouble_;
}

void HotReload::draw() const {
    const std::string wrong = message();
    if (wrong.empty() && doneFor_ <= 0) return;
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos(ImVec2(display.x / 2, 0.94F * display.y), ImGuiCond_Always, ImVec2(0.5F, 1.0F));
    ImGui::Begin("written", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoInputs | ImGuiWindowFlags_NoNav | ImGuiWindowFlags_NoSavedSettings |
                     ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoFocusOnAppearing);
    // Between the panels, where there is room.
    const float between = display.x - 2 * (std::clamp(0.26F * display.x, 320.0F, 420.0F) + 30);
    ImGui::PushTextWrapPos(std::clamp(between, 20 * ImGui::GetFontSize(), 60 * ImGui::GetFontSize()));
    if (wrong.empty()) {
        ImGui::TextUnformatted(done_.c_str());
    } else {
        ImGui::TextColored(refusedColour(), "reload failed; the last valid version stays in use");
        ImGui::TextUnformatted(wrong.c_str());
    }
    ImGui::PopTextWrapPos();
    ImGui::End();
}

}  // namespace rivulet
