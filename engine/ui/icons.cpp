#include "engine/ui/icons.h"

#include <imgui_internal.h>

#include <cstring>
#include <initializer_list>

namespace rivulet {

namespace {

// `low` and `s`: corner and side of the icon's square, px.
void drawIcon(ImDrawList& list, Icon icon, const ImVec2& low, float s, ImU32 colour) {
    const auto at = [&](float x, float y) { return ImVec2(low.x + x * s, low.y + y * s); };
    const auto box = [&](float x, float y, float right, float below) { list.AddRectFilled(at(x, y), at(right, below), colour); };
    const auto frame = [&](float x, float y, float right, float below) { list.AddRect(at(x, y), at(right, below), colour, 1.5F, 0, 1.3F); };
    constexpr float kLine = 1.5F, kPi = 3.14159265F;
    switch (icon) {
        case Icon::play:
            return list.AddTriangleFilled(at(0.2F, 0.08F), at(0.2F, 0.92F), at(0.92F, 0.5F), colour);
        case Icon::pause:
            box(0.18F, 0.1F, 0.4F, 0.9F);
            return box(0.6F, 0.1F, 0.82F, 0.9F);
        case Icon::step:
            list.AddTriangleFilled(at(0.1F, 0.1F), at(0.1F, 0.9F), at(0.68F, 0.5F), colour);
            return box(0.7F, 0.1F, 0.88F, 0.9F);
        case Icon::reset:
            list.PathArcTo(at(0.5F, 0.55F), 0.36F * s, -0.35F * kPi, 1.25F * kPi, 16);
            list.PathStroke(colour, 0, kLine);
            return list.AddTriangleFilled(at(0.38F, 0.0F), at(0.38F, 0.46F), at(0.78F, 0.2F), colour);
        case Icon::drop:
            list.AddCircleFilled(at(0.5F, 0.62F), 0.32F * s, colour, 16);
            return list.AddTriangleFilled(at(0.5F, 0.02F), at(0.22F, 0.5F), at(0.78F, 0.5F), colour);
        case Icon::scenes:
            for (const float x : {0.08F, 0.55F})
                for (const float y : {0.08F, 0.55F}) box(x, y, x + 0.37F, y + 0.37F);
            return;
        case Icon::save:
            box(0.43F, 0.05F, 0.57F, 0.5F);
            list.AddTriangleFilled(at(0.2F, 0.4F), at(0.8F, 0.4F), at(0.5F, 0.75F), colour);
            return box(0.08F, 0.82F, 0.92F, 0.95F);
        case Icon::picture:
            box(0.35F, 0.1F, 0.65F, 0.3F);
            frame(0.04F, 0.25F, 0.96F, 0.9F);
            return list.AddCircle(at(0.5F, 0.57F), 0.2F * s, colour, 12, kLine);
        case Icon::video:
            frame(0.02F, 0.2F, 0.68F, 0.82F);
            return list.AddTriangleFilled(at(0.68F, 0.5F), at(0.98F, 0.22F), at(0.98F, 0.8F), colour);
        case Icon::record:
            return list.AddCircleFilled(at(0.5F, 0.5F), 0.4F * s, IM_COL32(232, 84, 76, 255), 20);
        case Icon::measure:
            box(0.08F, 0.55F, 0.28F, 0.95F);
            box(0.4F, 0.1F, 0.6F, 0.95F);
            return box(0.72F, 0.35F, 0.92F, 0.95F);
        case Icon::keys:
            frame(0.0F, 0.2F, 1.0F, 0.85F);
            box(0.25F, 0.62F, 0.75F, 0.72F);
            for (const float x : {0.2F, 0.45F, 0.7F}) box(x, 0.36F, x + 0.12F, 0.48F);
            return;
        case Icon::hide:
            frame(0.04F, 0.12F, 0.96F, 0.9F);
            return box(0.04F, 0.12F, 0.36F, 0.9F);
    }
}

float side() { return 0.82F * ImGui::GetFontSize(); }
constexpr float kGap = 5;  // px, between icon and word

}  // namespace

float iconButtonWidth(const char* label) {
    return side() + kGap + ImGui::CalcTextSize(label, nullptr, true).x + 2 * ImGui::GetStyle().FramePadding.x;
}

bool iconButton(Icon icon, const char* label, const ImVec2& size, bool on) {
    // The word is drawn beside the icon instead of in the middle.
    ImGui::PushStyleColor(ImGuiCol_Text, IM_COL32_BLACK_TRANS);
    if (on) ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetStyleColorVec4(ImGuiCol_ButtonActive));
    const bool pressed = ImGui::Button(label, size);
    ImGui::PopStyleColor(on ? 2 : 1);
    const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const ImU32 colour = ImGui::GetColorU32(ImGuiCol_Text);
    const float x = low.x + ImGui::GetStyle().FramePadding.x, height = high.y - low.y;
    drawIcon(list, icon, ImVec2(x, low.y + 0.5F * (height - side())), side(), colour);
    const char* end = ImGui::FindRenderedTextEnd(label, label + std::strlen(label));
    list.AddText(ImVec2(x + side() + kGap, low.y + 0.5F * (height - ImGui::GetFontSize())), colour, label, end);
    return pressed;
}

}  // namespace rivulet
