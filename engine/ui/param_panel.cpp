#include "engine/ui/param_panel.h"

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <cctype>
#include <cmath>

namespace rivulet {

namespace {

constexpr double kSliderSpan = 200;  // a wider range than this is dragged, not slid: a slider's pixels would be too coarse
constexpr double kOpenRange = 1e6;   // a range beyond this stands for "any"

bool isOpen(const ParamInfo& info) { return info.min < -kOpenRange || info.max > kOpenRange; }

float srgbFromLinear(float c) { return c <= 0.0031308F ? 12.92F * c : 1.055F * std::pow(c, 1.0F / 2.4F) - 0.055F; }
float linearFromSrgb(float c) { return c <= 0.04045F ? c / 12.92F : std::pow((c + 0.055F) / 1.055F, 2.4F); }

// Digits enough to tell the range's steps apart.
const char* formatFor(const ParamInfo& info, float v) {
    if (info.logarithmic || isOpen(info)) return "%.4g";
    float size = std::max(std::abs(v), static_cast<float>(info.max - info.min) * 0.1F);
    return size < 0.1F ? "%.5f" : size < 10.0F ? "%.3f" : "%.2f";
}

}  // namespace

std::string readableName(std::string_view name) {
    std::string text;
    for (char c : name) {
        bool upper = std::isupper(static_cast<unsigned char>(c)) != 0;
        if (upper && !text.empty()) text += ' ';
        text += upper ? static_cast<char>(std::tolower(static_cast<unsigned char>(c))) : c;
    }
    return text;
}

ParamPanel::ParamPanel() = default;

void ParamPanel::label(const ParamInfo& info) {
    ImGui::PushID(info.name);
    float left = ImGui::GetCursorPosX();
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted(readableName(info.name).c_str());
    if (ImGui::IsItemHovered() && info.doc[0] != '\0') {
        std::string text = info.doc;
        if (info.unit[0] != '\0') text += fmt::format("\nunit: {}", info.unit);
        if (!isOpen(info) && info.max < kOpenRange) text += fmt::format("\nrange: {:g} to {:g}", info.min, info.max);
        if (info.fixed) text += "\nthe water starts anew when this changes";
        ImGui::BeginTooltip();
        ImGui::PushTextWrapPos(ImGui::GetFontSize() * 22);
        ImGui::TextUnformatted(text.c_str());
        ImGui::PopTextWrapPos();
        ImGui::EndTooltip();
    }
    // Widgets stand in one column whatever the nesting; the unit, dimmed, at its right.
    float column = std::max(left + 20, ImGui::GetWindowWidth() * 0.42F);
    ImGui::SameLine(column);
    float unit = info.unit[0] != '\0' || info.max < kOpenRange ? ImGui::CalcTextSize("m^2/s^2").x + 8 : 0;  // text fields have none
    ImGui::SetNextItemWidth(std::max(40.0F, ImGui::GetContentRegionAvail().x - unit));
}

void ParamPanel::settle(const ParamInfo& info, bool edited) {
    changed_ = changed_ || edited;
    if (info.fixed && ImGui::IsItemDeactivatedAfterEdit()) recreate_ = true;
    if (info.unit[0] != '\0') {
        ImGui::SameLine(0, 6);
        ImGui::TextDisabled("%s", info.unit);
    }
    ImGui::PopID();
}

bool ParamPanel::floats(const ParamInfo& info, float* v, int count) {
    float before[3] = {0, 0, 0};
    std::copy_n(v, count, before);
    float low = static_cast<float>(info.min), high = static_cast<float>(info.max);
    const char* format = formatFor(info, v[0]);
    ImGuiSliderFlags flags = ImGuiSliderFlags_AlwaysClamp;
    bool edited = false;
    if (info.logarithmic && !isOpen(info)) {
        edited = ImGui::SliderScalarN("##v", ImGuiDataType_Float, v, count, &low, &high, format, flags | ImGuiSliderFlags_Logarithmic);
    } else if (!isOpen(info) && info.max - info.min <= kSliderSpan) {
        edited = ImGui::SliderScalarN("##v", ImGuiDataType_Float, v, count, &low, &high, format, flags);
    } else {
        float largest = 0;
        for (int i = 0; i < count; ++i) largest = std::max(largest, std::abs(v[i]));
        edited = ImGui::DragScalarN("##v", ImGuiDataType_Float, v, count, std::max(0.005F * largest, 0.002F), &low, &high, format, flags);
    }
    if (!edited) return false;
    // A typed "nan" passes ImGui's clamp, and so does anything where the range is open.
    for (int i = 0; i < count; ++i) v[i] = std::isfinite(v[i]) ? std::clamp(v[i], low, high) : before[i];
    return !std::equal(v, v + count, before);
}

void ParamPanel::value(const ParamInfo& info, float& v) {
    if (hidden()) return;
    label(info);
    settle(info, floats(info, &v, 1));
}

void ParamPanel::value(const ParamInfo& info, vec3& v) {
    if (hidden()) return;
    label(info);
    settle(info, floats(info, &v.x, 3));
}

void ParamPanel::value(const ParamInfo& info, int& v) {
    if (hidden()) return;
    label(info);
    constexpr double kWidest = 1e9;
    int low = static_cast<int>(std::max(info.min, -kWidest)), high = static_cast<int>(std::min(info.max, kWidest));
    bool edited = false;
    if (high - static_cast<double>(low) <= 2000) {
        edited = ImGui::SliderInt("##v", &v, low, high, "%d",
                                  ImGuiSliderFlags_AlwaysClamp | (info.logarithmic ? ImGuiSliderFlags_Logarithmic : 0));
    } else {
        edited = ImGui::DragInt("##v", &v, std::max(1.0F, 0.005F * static_cast<float>(std::abs(v))), low, high, "%d",
                                ImGuiSliderFlags_AlwaysClamp);
    }
    settle(info, edited);
}

void ParamPanel::value(const ParamInfo& info, bool& v) {
    if (hidden()) return;
    label(info);
    settle(info, ImGui::Checkbox("##v", &v));
}

void ParamPanel::value(const ParamInfo& info, std::string& v) {
    if (hidden()) return;
    label(info);
    settle(info, ImGui::InputText("##v", &v));
}

void ParamPanel::colour(const ParamInfo& info, vec3& v) {
    if (hidden()) return;
    label(info);
    // Colours are linear in the struct and sRGB on the screen, or the swatch would not look like the colour.
    bool bright = info.max > 1;
    float shown[3];
    for (int i = 0; i < 3; ++i) shown[i] = bright ? v[i] : srgbFromLinear(v[i]);
    ImGuiColorEditFlags flags = ImGuiColorEditFlags_Float | (bright ? ImGuiColorEditFlags_HDR : 0);
    bool edited = ImGui::ColorEdit3("##v", shown, flags);
    if (edited)
        for (int i = 0; i < 3; ++i) {
            float c = bright ? shown[i] : linearFromSrgb(shown[i]);
            if (std::isfinite(c)) v[i] = std::clamp(c, static_cast<float>(info.min), static_cast<float>(info.max));
        }
    settle(info, edited);
}

void ParamPanel::choice(const ParamInfo& info, std::string& v, std::span<const std::string> names) {
    if (hidden()) return;
    label(info);
    bool edited = false;
    if (ImGui::BeginCombo("##v", v.c_str())) {
        for (const std::string& name : names) {
            if (ImGui::Selectable(name.c_str(), name == v) && name != v) {
                v = name;
                edited = true;
            }
            if (name == v) ImGui::SetItemDefaultFocus();
        }
        ImGui::EndCombo();
    }
    if (edited && info.fixed) recreate_ = true;
    settle(info, edited);
}

bool ParamPanel::beginGroup(const ParamInfo& info) {
    if (hidden()) return false;
    std::string title = readableName(info.name);
    ImGui::PushID(info.name);
    bool open = depth_ == 0 ? ImGui::CollapsingHeader(title.c_str()) : ImGui::TreeNodeEx(title.c_str(), ImGuiTreeNodeFlags_SpanAvailWidth);
    if (!open) {
        ImGui::PopID();
        return false;
    }
    if (depth_ == 0) ImGui::Indent(6);
    ++depth_;
    return true;
}

void ParamPanel::endGroup() {
    --depth_;
    if (depth_ == 0)
        ImGui::Unindent(6);
    else
        ImGui::TreePop();
    ImGui::PopID();
}

// A folded list still visits its items (the length must be kept), so they are told to draw nothing.
size_t ParamPanel::beginList(const ParamInfo& info, size_t current) {
    size_t wanted = current;
    bool open = false;
    if (!hidden()) {
        ImGui::PushID(info.name);
        std::string title = fmt::format("{} ({})###list", readableName(info.name), current);
        open = depth_ == 0 ? ImGui::CollapsingHeader(title.c_str()) : ImGui::TreeNodeEx(title.c_str(), ImGuiTreeNodeFlags_SpanAvailWidth);
        if (open) {
            if (depth_ == 0) ImGui::Indent(6);
            constexpr size_t kMost = 64;
            if (ImGui::SmallButton("add") && current < kMost) wanted = current + 1;
            ImGui::SameLine();
            if (ImGui::SmallButton("remove last") && current > 0) wanted = current - 1;
        } else {
            ImGui::PopID();
        }
    }
    if (wanted != current) changed_ = recreate_ = true;
    open_.push_back(open);
    closed_ += open ? 0 : 1;
    depth_ += open ? 1 : 0;
    return wanted;
}

void ParamPanel::beginItem(size_t index) {
    bool open = false;
    if (!hidden()) {
        ImGui::PushID(static_cast<int>(index));
        open = ImGui::TreeNodeEx("item", ImGuiTreeNodeFlags_SpanAvailWidth | ImGuiTreeNodeFlags_DefaultOpen, "%d", static_cast<int>(index));
        if (!open) ImGui::PopID();
    }
    open_.push_back(open);
    closed_ += open ? 0 : 1;
    depth_ += open ? 1 : 0;
}

void ParamPanel::endItem() {
    bool open = open_.back();
    open_.pop_back();
    if (!open) {
        --closed_;
        return;
    }
    --depth_;
    ImGui::TreePop();
    ImGui::PopID();
}

void ParamPanel::endList() {
    bool open = open_.back();
    open_.pop_back();
    if (!open) {
        --closed_;
        return;
    }
    --depth_;
    if (depth_ == 0)
        ImGui::Unindent(6);
    else
        ImGui::TreePop();
    ImGui::PopID();
}

}  // namespace rivulet
