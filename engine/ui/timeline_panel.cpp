#include "engine/ui/timeline_panel.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

namespace rivulet {

namespace {

constexpr double kShown = 2, kLate = 4;       // frames
constexpr double kLeast = 0.005, kMost = 10;  // s, of a frame

ImU32 colourOf(const std::string& name) {
    const auto hash = static_cast<float>(std::hash<std::string>()(name) % 1024) / 1024.0F;
    return ImColor::HSV(hash, 0.5F, 0.9F);
}

}  // namespace

void TimelinePanel::draw(const Timeline& timeline, double frame, float width) {
    if (!held_) {
        frame = std::clamp(frame, kLeast, kMost);
        until_ = hostSeconds() - kLate * frame;
        shown_ = kShown * frame;
    }
    const std::vector<Timeline::Lane> lanes = timeline.lanes(until_ - shown_);
    const float row = ImGui::GetTextLineHeight() + 4;
    const ImVec2 low = ImGui::GetCursorScreenPos(), size(width, row * static_cast<float>(std::max<size_t>(lanes.size(), 1)));
    ImGui::Dummy(size);
    held_ = ImGui::IsItemHovered();
    ImDrawList* list = ImGui::GetWindowDrawList();
    const ImVec2 high(low.x + size.x, low.y + size.y);
    list->AddRectFilled(low, high, ImGui::GetColorU32(ImGuiCol_FrameBg), 4);
    list->PushClipRect(low, high, true);
    const ImVec2 mouse = ImGui::GetIO().MousePos;
    const auto at = [&](double seconds) { return low.x + size.x * static_cast<float>(1 + (seconds - until_) / shown_); };
    const PassSpan* pointed = nullptr;
    for (size_t k = 0; k < lanes.size(); ++k) {
        const float top = low.y + row * static_cast<float>(k);
        float drawn = 0;
        for (const PassSpan& span : lanes[k].spans) {
            if (span.begin > until_) continue;
            const ImVec2 a(at(span.begin), top + 2), b(std::max(at(span.end), a.x + 0.5F), top + row - 2);
            constexpr float kSeen = 0.7F, kRounded = 4;  // px: of what is less not all are drawn; below the other, corners are not seen
            if (b.x - a.x >= kSeen || a.x - drawn >= kSeen) {
                list->AddRectFilled(a, b, colourOf(span.name), b.x - a.x > kRounded ? 1 : 0);
                drawn = a.x;
            }
            if (held_ && mouse.x >= a.x && mouse.x <= b.x && mouse.y >= top && mouse.y < top + row) pointed = &span;
        }
        const ImVec2 named = ImGui::CalcTextSize(lanes[k].name.c_str());  // readable over any colour
        list->AddRectFilled(ImVec2(low.x + 1, top + 1), ImVec2(low.x + named.x + 8, top + row - 1), IM_COL32(10, 14, 18, 190), 3);
        list->AddText(ImVec2(low.x + 4, top + 2), IM_COL32(255, 255, 255, 220), lanes[k].name.c_str());
    }
    list->PopClipRect();
    if (pointed != nullptr)
        ImGui::SetTooltip("%s", fmt::format("{}: {:.2f} ms", pointed->name, 1000 * (pointed->end - pointed->begin)).c_str());
}

}  // namespace rivulet
