#include "fluid/viewer/message_bar.h"

#include <imgui.h>

#include <algorithm>
#include <utility>

#include "engine/core/message_line.h"

namespace rivulet {

void MessageBar::draw(std::string text, double seconds, bool hidden) {
    constexpr double kReading = 12;  // s
    text = messageLine(text);
    const bool same = text == shown_;
    shownFor_ = same ? shownFor_ + seconds : 0;
    shown_ = std::move(text);
    if (shown_.empty() || shownFor_ > kReading || hidden) return;
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos(ImVec2(display.x / 2, 0.94F * display.y), ImGuiCond_Always, ImVec2(0.5F, 1.0F));
    ImGui::Begin("said", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoInputs | ImGuiWindowFlags_NoNav | ImGuiWindowFlags_NoSavedSettings |
                     ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoFocusOnAppearing);
    ImGui::PushTextWrapPos(std::min(0.8F * display.x, 40 * ImGui::GetFontSize()));
    ImGui::TextUnformatted(shown_.c_str());
    ImGui::PopTextWrapPos();
    ImGui::End();
}

}  // namespace rivulet
