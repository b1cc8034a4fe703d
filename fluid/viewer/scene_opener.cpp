#include "fluid/viewer/scene_opener.h"

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_internal.h>

#include <algorithm>
#include <utility>

#include "engine/core/message_line.h"

namespace rivulet {

void SceneOpener::begin(Share share, std::string clDevice, const GlFacts& gl, const Log& log) {
    share_ = std::move(share);
    clDevice_ = std::move(clDevice);
    gl_ = gl;
    log_ = log;
}

bool SceneOpener::aside(std::string* trouble) {
    if (share_ && !context_) {
        Result<SharedGl> made = share_();
        if (made) context_ = std::move(*made);
        if (!made && trouble != nullptr) {
            *trouble = made.error().message;
            share_ = {};
        }
    }
    return static_cast<bool>(context_);
}

void SceneOpener::start(SceneFile scene, Cause cause, const SceneFile& before, Backend backend, const std::string& asked, bool renderer) {
    giveUp();
    work_ = std::make_unique<Work>();
    work_->cause = cause;
    work_->before = before;
    work_->opening = std::make_unique<SceneOpening>(SceneOpening::Request{.scene = std::move(scene),
                                                                          .device = makeDevice(backendName(backend), gl_, log_, clDevice_),
                                                                          .backend = asked,
                                                                          .renderer = renderer,
                                                                          .gl = context_,
                                                                          .log = log_});
}

void SceneOpener::giveUp() {
    if (!work_) return;
    work_->opening->giveUp();
    givenUp_.push_back(std::move(work_->opening));
    work_.reset();
}

SceneOpener::Work SceneOpener::take() {
    Work done = std::move(*work_);
    work_.reset();
    return done;
}

void SceneOpener::collect() {
    std::erase_if(givenUp_, [](const std::unique_ptr<SceneOpening>& each) { return each->ready(); });
}

Result<OpenedScene> SceneOpener::openFirst(const SceneFile& scene, std::unique_ptr<Device> device, const std::string& backend,
                                           const std::function<bool(const SceneOpening&)>& pump) {
    SceneOpening work({.scene = scene, .device = std::move(device), .backend = backend, .renderer = true, .gl = context_, .log = log_});
    constexpr double kPicture = 0.05;  // s: the machine has better things to do
    while (!work.ready(kPicture))
        if (!pump(work)) return failed(fmt::format("opening {} was cancelled", scene.name));
    return work.take();
}

bool SceneOpener::drawProgress(const SceneOpening& work, float height, float left) {
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    const SceneOpening::Step step = work.step();
    ImGui::SetNextWindowPos(ImVec2(0.5F * (left + display.x), height * display.y), ImGuiCond_Always, ImVec2(0.5F, 0.5F));
    ImGui::SetNextWindowBgAlpha(1);  // a panel may lie under it
    ImGui::Begin(
        "opening", nullptr,
        ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoFocusOnAppearing);
    ImGui::BringWindowToDisplayFront(ImGui::GetCurrentWindow());  // without the focus, which a person may need elsewhere
    const float em = ImGui::GetFontSize();
    constexpr size_t kName = 60;  // characters
    ImGui::Text("%s: %s", messageLine(work.scene().name, kName).c_str(), step.what.c_str());
    ImGui::ProgressBar(static_cast<float>(step.share), ImVec2(std::clamp(display.x - left - 8 * em, 4 * em, 20 * em), 0));
    ImGui::SameLine();
    const bool cancel = ImGui::Button("cancel");
    ImGui::End();
    return cancel;
}

}  // namespace rivulet
