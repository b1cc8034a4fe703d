#include "engine/ui/profiler_panel.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

namespace rivulet {

namespace {

// Hues apart by the golden ratio: neighbours in the list never look alike.
ImU32 hueOf(size_t index) {
    float hue = std::fmod(0.55F + 0.618034F * static_cast<float>(index), 1.0F);
    return ImColor::HSV(hue, 0.55F, 0.90F);
}

}  // namespace

double ProfilerPanel::meanOf(const std::vector<float>& ring) const {
    int frames = std::min(filled_, kMeanFrames);
    double sum = 0;
    for (int k = 1; k <= frames; ++k) sum += static_cast<double>(ring[static_cast<size_t>((at_ - k + kFrames) % kFrames)]);
    return frames > 0 ? sum / frames : 0;
}

ProfilerPanel::Line& ProfilerPanel::line(std::string_view side, std::string_view name) {
    auto found = std::find_if(lines_.begin(), lines_.end(), [&](const Line& l) { return l.side == side && l.name == name; });
    if (found != lines_.end()) return *found;
    Line fresh;
    fresh.side = side;
    fresh.name = name;
    // A side's passes stay together, so that the graph stacks them side by side.
    auto after = std::find_if(lines_.rbegin(), lines_.rend(), [&](const Line& l) { return l.side == side; });
    return *lines_.insert(after == lines_.rend() ? lines_.end() : after.base(), std::move(fresh));
}

void ProfilerPanel::add(std::string_view side, std::span<const PassTime> passes) {
    for (const PassTime& pass : passes) line(side, pass.name).ms[static_cast<size_t>(at_)] += static_cast<float>(pass.ms);
}

void ProfilerPanel::endFrame(double frameMs) {
    frame_[static_cast<size_t>(at_)] = static_cast<float>(frameMs);
    at_ = (at_ + 1) % kFrames;
    filled_ = std::min(filled_ + 1, kFrames - 1);
    frame_[static_cast<size_t>(at_)] = 0;
    for (Line& l : lines_) l.ms[static_cast<size_t>(at_)] = 0;
}

void ProfilerPanel::clear() {
    lines_.clear();
    filled_ = 0;
    std::fill(frame_.begin(), frame_.end(), 0.0F);
}

double ProfilerPanel::mean(std::string_view side) const {
    double sum = 0;
    for (const Line& l : lines_)
        if (l.side == side) sum += meanOf(l.ms);
    return sum;
}

double ProfilerPanel::meanFrame() const { return meanOf(frame_); }

void ProfilerPanel::draw(float width) const {
    drawGraph(width);
    drawTable();
}

// Passes stacked from the bottom, one column of colour for the longer of two frames, newest at the right; the frames' whole times as a
// line above. A rectangle a pass and frame would be more than the rest of the window together.
void ProfilerPanel::drawGraph(float across) const {
    ImVec2 size(across, 110);
    ImVec2 low = ImGui::GetCursorScreenPos(), high(low.x + size.x, low.y + size.y);
    ImGui::Dummy(size);
    const bool hovered = ImGui::IsItemHovered();
    ImDrawList* list = ImGui::GetWindowDrawList();
    list->AddRectFilled(low, high, ImGui::GetColorU32(ImGuiCol_FrameBg), 4);

    float top = 1;
    for (int k = 0; k < kFrames; ++k) {
        float stack = 0;
        for (const Line& l : lines_) stack += l.ms[static_cast<size_t>(k)];
        top = std::max({top, stack, frame_[static_cast<size_t>(k)]});
    }
    top = std::exp2(std::ceil(std::log2(top) * 2) / 2);  // steps of sqrt(2), so that the scale does not tremble

    list->PushClipRect(low, high, true);
    float width = size.x / kFrames;
    std::vector<ImVec2> whole;  // the frames' own line
    whole.reserve(kFrames);
    auto height = [&](float ms) { return high.y - size.y * ms / top; };
    const auto stackOf = [&](size_t frame) {
        float sum = 0;
        for (const Line& l : lines_) sum += l.ms[frame];
        return sum;
    };
    for (int k = 1; k < kFrames; ++k) {
        size_t from = static_cast<size_t>((at_ + k) % kFrames);
        float x = low.x + width * static_cast<float>(k - 1), stack = 0;
        whole.emplace_back(x + 0.5F * width, height(frame_[from]));
        if (from % 2 != 0) continue;  // the same two together in every picture
        if (k + 1 < kFrames && stackOf(from + 1) > stackOf(from)) ++from;
        constexpr float kSeen = 2;  // px: what is less goes with the next, for most passes are short and each is a rectangle
        float drawn = 0;
        for (size_t i = 0; i < lines_.size(); ++i) {
            stack += lines_[i].ms[from];
            if ((stack - drawn) * size.y < kSeen * top) continue;
            list->AddRectFilled(ImVec2(x, height(stack)), ImVec2(x + 2 * width + 0.5F, height(drawn)), hueOf(i));
            drawn = stack;
        }
    }
    list->AddPolyline(whole.data(), static_cast<int>(whole.size()), IM_COL32(235, 240, 245, 160), 0, 1);
    float below = low.y;  // no text is written over another
    for (float ms : {0.999F * top, 1000.0F / 30, 1000.0F / 60}) {
        if (ms >= top || height(ms) < below) continue;
        const std::string text = ms < 100 ? fmt::format("{:.3g} ms", ms) : fmt::format("{:.0f} ms", ms);
        const ImVec2 at(low.x + 4, height(ms) + 1), box = ImGui::CalcTextSize(text.c_str());
        list->AddLine(ImVec2(low.x, height(ms)), ImVec2(high.x, height(ms)), IM_COL32(255, 255, 255, 60));
        if (at.y + box.y > high.y) continue;
        list->AddRectFilled(ImVec2(at.x - 2, at.y), ImVec2(at.x + box.x + 2, at.y + box.y), IM_COL32(20, 26, 32, 170), 3);
        list->AddText(at, IM_COL32(255, 255, 255, 200), text.c_str());
        below = at.y + box.y;
    }
    list->PopClipRect();
    if (hovered) tell((ImGui::GetIO().MousePos.x - low.x) / width);
}

// The frame under the mouse, with what took longest in it.
void ProfilerPanel::tell(float column) const {
    const auto k = static_cast<size_t>(std::clamp(static_cast<int>(column) + 1, 1, kFrames - 1));
    const size_t at = (static_cast<size_t>(at_) + k) % kFrames;
    std::vector<size_t> order;
    for (size_t i = 0; i < lines_.size(); ++i)
        if (lines_[i].ms[at] > 0) order.push_back(i);
    std::sort(order.begin(), order.end(), [&](size_t a, size_t b) { return lines_[a].ms[at] > lines_[b].ms[at]; });
    constexpr size_t kMost = 8;
    ImGui::BeginTooltip();
    ImGui::Text("frame: %.2f ms", static_cast<double>(frame_[at]));
    for (size_t i = 0; i < std::min(order.size(), kMost); ++i) {
        const Line& l = lines_[order[i]];
        ImGui::TextColored(ImColor(hueOf(order[i])), "%7.2f  %s", static_cast<double>(l.ms[at]), l.name.c_str() + (l.name.rfind('/') + 1));
    }
    ImGui::EndTooltip();
}

void ProfilerPanel::drawTable() const {
    if (!ImGui::BeginTable("passes", 3, ImGuiTableFlags_SizingStretchProp)) return;
    ImGui::TableSetupColumn("pass", ImGuiTableColumnFlags_WidthStretch, 3);
    ImGui::TableSetupColumn("ms", ImGuiTableColumnFlags_WidthFixed, 56);
    ImGui::TableSetupColumn("share", ImGuiTableColumnFlags_WidthStretch, 2);
    double most = 1e-6;
    for (const Line& l : lines_) most = std::max(most, meanOf(l.ms));
    std::string side;
    for (size_t i = 0; i < lines_.size(); ++i) {
        const Line& l = lines_[i];
        if (l.side != side) {
            side = l.side;
            ImGui::TableNextRow();
            ImGui::TableNextColumn();
            ImGui::TextUnformatted(side.c_str());
            ImGui::TableNextColumn();
            ImGui::Text("%7.2f", mean(side));
        }
        double ms = meanOf(l.ms);
        ImGui::TableNextRow();
        ImGui::TableNextColumn();
        ImGui::Indent(8);
        ImGui::TextColored(ImColor(hueOf(i)), "%s",
                           l.name.c_str() + (l.name.rfind('/') + 1));  // "fluid/methods/integrate": the folder says nothing here
        ImGui::Unindent(8);
        ImGui::TableNextColumn();
        ImGui::Text("%7.2f", ms);
        ImGui::TableNextColumn();
        ImVec2 at = ImGui::GetCursorScreenPos();
        float width = ImGui::GetContentRegionAvail().x * static_cast<float>(ms / most), tall = ImGui::GetTextLineHeight();
        ImGui::GetWindowDrawList()->AddRectFilled(ImVec2(at.x, at.y + 3), ImVec2(at.x + width, at.y + tall - 2), hueOf(i), 2);
    }
    ImGui::EndTable();
}

}  // namespace rivulet
