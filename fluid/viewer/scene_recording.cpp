#include "fluid/viewer/scene_recording.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <utility>

#include "engine/ui/icons.h"
#include "fluid/viewer/screen_capture.h"

namespace rivulet {

Status SceneRecording::toggle(const Session& session, const Log& log) {
    if (writer_) return end(log);
    if (session.replaying() != nullptr) return badInput("a recording is shown: press simulate in its timeline before you record");
    if (!session.flows().empty()) return badInput("a recording cannot store flow on skins: record a video instead");
    Result<std::string> path = freePath(session.scene().name, "rrec");
    if (!path) return path.error();
    Result<RecordingWriter> writer = RecordingWriter::open(*path, recordedText(session));
    if (!writer) return writer.error();
    writer_ = std::move(*writer);
    path_ = std::move(*path);
    frames_ = 0;
    from_ = to_ = session.time();
    log.notice("recording the run; press F8 to stop");
    return stepped(session);
}

Status SceneRecording::end(const Log& log) {
    if (!writer_) return ok();
    RecordingWriter done = std::move(*writer_);
    writer_.reset();
    const Status closed = done.close();
    if (closed)
        log.notice(fmt::format("recording saved: {}", path_));
    else
        path_.clear();
    return closed;
}

Status SceneRecording::stepped(const Session& session) {
    if (!writer_ || session.replaying() != nullptr) return ok();
    Status added = writer_->add(frameOf(session));
    ++frames_;
    to_ = session.time();
    if (!added) {
        writer_.reset();
        path_.clear();
    }
    return added;
}

SceneRecording::Asked SceneRecording::drawTimeline(const Session& session, float left, float right) {
    Asked asked;
    const Replay* replay = session.replaying();
    if (!recording() && path_.empty() && replay == nullptr) return asked;
    constexpr float kMargin = 10;
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos(ImVec2(left, display.y - kMargin), ImGuiCond_Always, ImVec2(0, 1));
    ImGui::SetNextWindowSize(ImVec2(std::max(right - left, 1.0F), 0), ImGuiCond_Always);
    ImGui::Begin("timeline", nullptr,
                 ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                     ImGuiWindowFlags_NoFocusOnAppearing);
    const ImVec2 button(iconButtonWidth("simulate"), 0);
    if (recording()) {
        if (iconButton(Icon::record, "stop", button, true)) asked.ask = Ask::stop;
        ImGui::SameLine();
        ImGui::Text("recording: %zu frames, %.2f s to %.2f s", frames_, from_, to_);
    } else {
        if (replay == nullptr && iconButton(Icon::play, "replay", button)) asked.ask = Ask::replay;
        if (replay != nullptr && iconButton(Icon::drop, "simulate", button)) asked.ask = Ask::simulate;
        if (replay != nullptr && ImGui::IsItemHovered()) ImGui::SetTooltip("go back to the simulation");
        ImGui::SameLine();
        const size_t frames = replay != nullptr ? replay->frames() : frames_;
        int at = replay != nullptr ? static_cast<int>(replay->at()) : 0;
        ImGui::SetNextItemWidth(-1);
        ImGui::BeginDisabled(frames < 2);
        const std::string text =
            replay != nullptr ? fmt::format("frame {} of {}, {:.2f} s", at + 1, frames, replay->shown().time)
                              : fmt::format("{} recorded frames, {:.2f} s to {:.2f} s: drag to look through them", frames, from_, to_);
        if (ImGui::SliderInt("##frame", &at, 0, std::max(static_cast<int>(frames) - 1, 1), text.c_str(),
                             ImGuiSliderFlags_AlwaysClamp | ImGuiSliderFlags_NoInput))
            asked = {Ask::scrub, static_cast<size_t>(at)};
        ImGui::EndDisabled();
    }
    ImGui::End();
    return asked;
}

}  // namespace rivulet
