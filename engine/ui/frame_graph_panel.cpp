#include "engine/ui/frame_graph_panel.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "engine/gpu/frame_graph.h"
#include "engine/ui/plot.h"

namespace rivulet {

namespace {

using Graph = gpu::FrameGraphDescription;

std::string megabytes(size_t bytes) { return fmt::format("{:.2f}", static_cast<double>(bytes) * 1e-6); }

std::string sizeOf(const Graph::Resource& r) {
    if (!r.isTexture) return "buffer";
    const std::string flat = fmt::format("{} x {}", r.width, r.height);
    return r.layers > 1 ? fmt::format("{} x {}", flat, r.layers) : flat;
}

bool uses(const std::vector<Graph::Use>& list, size_t resource) {
    return std::any_of(list.begin(), list.end(), [&](const Graph::Use& use) { return use.resource == resource; });
}

void tellUses(const Graph& graph, const char* what, const std::vector<Graph::Use>& list) {
    for (const Graph::Use& use : list) {
        const Graph::Resource& r = graph.resources[use.resource];
        ImGui::TextDisabled("%s", &use == list.data() ? what : "");
        ImGui::SameLine(ImGui::GetFontSize() * 4);
        ImGui::Text("%s (%s%s)", r.name.c_str(), gpu::usageName(use.usage), r.imported ? ", imported" : "");
    }
}

void textRight(const std::string& text) {
    const float left = ImGui::GetContentRegionAvail().x - ImGui::CalcTextSize(text.c_str()).x;
    ImGui::SetCursorPosX(ImGui::GetCursorPosX() + std::max(0.0F, left));
    ImGui::TextUnformatted(text.c_str());
}

}  // namespace

// Where things are, pixels.
struct FrameGraphPanel::Layout {
    ImVec2 low;  // of the first pass's row
    float width = 0, row = 0, names = 0, column = 0;
    double most = 0;         // ms, of the slowest pass
    std::vector<double> ms;  // of each pass; NaN: it shares a row with one before, or left out
    std::vector<int> calls;  // of that row
    float top(size_t pass) const { return low.y + row * static_cast<float>(pass); }
    float columnAt(size_t memory) const { return low.x + names + column * static_cast<float>(memory); }
};

void FrameGraphPanel::draw(const Graph& graph, std::span<const PassTime> times, float width) {
    Layout layout;
    layout.width = width;
    layout.row = std::floor(ImGui::GetTextLineHeight() + 3);
    layout.names = std::floor(std::min(0.62F * width, 20 * ImGui::GetFontSize()));
    layout.column =
        std::clamp((width - layout.names) / static_cast<float>(std::max<size_t>(graph.memories, 1)), 3.0F, 1.6F * ImGui::GetFontSize());
    layout.ms.assign(graph.passes.size(), NAN);
    layout.calls.assign(graph.passes.size(), 1);
    double sum = 0;
    ms_.resize(times.size(), -1);
    for (size_t k = 0; k < times.size(); ++k) {
        constexpr double kGently = 0.1;
        ms_[k] = ms_[k] < 0 ? times[k].ms : ms_[k] + kGently * (times[k].ms - ms_[k]);
        sum += times[k].ms;
        const auto first = std::find_if(graph.passes.begin(), graph.passes.end(),
                                        [&](const Graph::Pass& pass) { return pass.name == times[k].name && !pass.culled; });
        if (first == graph.passes.end()) continue;
        const auto p = static_cast<size_t>(first - graph.passes.begin());
        layout.ms[p] = ms_[k];
        layout.calls[p] = times[k].calls;
        layout.most = std::max(layout.most, ms_[k]);
    }
    const auto left = std::count_if(graph.passes.begin(), graph.passes.end(), [](const Graph::Pass& pass) { return pass.culled; });
    size_t asked = 0;
    for (const Graph::Resource& r : graph.resources)
        if (r.memory != SIZE_MAX) asked += r.bytes;
    ImGui::Text("%zu passes, %.2f ms%s", graph.passes.size() - static_cast<size_t>(left), sum,
                left > 0 ? fmt::format("; {} culled", left).c_str() : "");
    ImGui::TextDisabled("%zu allocations, %s MB of textures share %s MB", graph.memories, megabytes(asked).c_str(),
                        megabytes(graph.lentBytes).c_str());
    ImGui::TextDisabled("passes");
    ImGui::SameLine(layout.names + ImGui::GetStyle().WindowPadding.x);
    ImGui::TextDisabled("memory: filled = written, ring = read");
    layout.low = ImGui::GetCursorScreenPos();
    pointing_ = SIZE_MAX;
    rows_.clear();
    for (size_t p = 0; p < graph.passes.size(); ++p) drawPass(graph, p, layout);
    drawBars(graph, layout);
    ImGui::Spacing();
    drawResources(graph);
    pointed_ = pointing_;
}

void FrameGraphPanel::drawPass(const Graph& graph, size_t p, const Layout& layout) {
    const Graph::Pass& pass = graph.passes[p];
    const float top = layout.top(p), font = ImGui::GetFontSize();
    ImGui::SetCursorScreenPos(ImVec2(layout.low.x, top));
    ImGui::Dummy(ImVec2(layout.width, layout.row));
    ImDrawList* list = ImGui::GetWindowDrawList();
    const ImVec2 mouse = ImGui::GetIO().MousePos;
    const bool hovered = ImGui::IsItemHovered();
    const bool marked = pointed_ != SIZE_MAX && (uses(pass.reads, pointed_) || uses(pass.writes, pointed_));
    if (hovered || marked)
        list->AddRectFilled(ImVec2(layout.low.x, top), ImVec2(layout.low.x + layout.width, top + layout.row), IM_COL32(255, 255, 255, 24));
    const ImU32 text = ImGui::GetColorU32(pass.culled ? ImGuiCol_TextDisabled : ImGuiCol_Text);
    const float msAt = layout.low.x + layout.names - 8.2F * font;
    const ImVec4 room(layout.low.x, top, msAt - 4, top + layout.row);  // a clip rectangle would be a draw call each
    list->AddText(ImGui::GetFont(), font, ImVec2(layout.low.x + 2, top + 1), text, pass.name.c_str(), nullptr, 0, &room);
    const double ms = layout.ms[p];
    const std::string figure = pass.culled ? "culled" : std::isfinite(ms) ? fmt::format("{:.2f}", ms) : "\"";
    const float wide = ImGui::CalcTextSize(figure.c_str()).x;
    rows_.push_back({pass.name, figure});
    list->AddText(ImVec2(msAt + 3.6F * font - wide, top + 1), text, figure.c_str());
    if (std::isfinite(ms) && layout.most > 0) {
        const float x = msAt + 3.9F * font, bar = 3.8F * font * static_cast<float>(ms / layout.most);
        list->AddRectFilled(ImVec2(x, top + 4), ImVec2(x + std::max(bar, 1.0F), top + layout.row - 3), plotColour(0), 2);
    }
    if (!hovered) return;
    // Which of its resources is under the mouse.
    size_t under = SIZE_MAX;
    if (mouse.x >= layout.columnAt(0)) {
        const auto memory = static_cast<size_t>((mouse.x - layout.columnAt(0)) / layout.column);
        for (size_t r = 0; r < graph.resources.size(); ++r)
            if (graph.resources[r].memory == memory && graph.resources[r].first <= p && p <= graph.resources[r].last) under = r;
    }
    if (under != SIZE_MAX) {
        pointing_ = under;
        tellResource(graph, under);
        return;
    }
    ImGui::BeginTooltip();
    ImGui::TextUnformatted(pass.name.c_str());
    if (pass.culled) ImGui::TextDisabled("culled: no pass reads its output");
    if (std::isfinite(ms) && layout.calls[p] > 1) ImGui::TextDisabled("%.3f ms for all %d passes of this name", ms, layout.calls[p]);
    if (std::isfinite(ms) && layout.calls[p] == 1) ImGui::TextDisabled("%.3f ms", ms);
    tellUses(graph, "reads", pass.reads);
    tellUses(graph, "writes", pass.writes);
    ImGui::EndTooltip();
}

void FrameGraphPanel::drawBars(const Graph& graph, const Layout& layout) {
    ImDrawList* list = ImGui::GetWindowDrawList();
    const float bottom = layout.top(graph.passes.size()), inset = layout.column > 8 ? 2.0F : 0.5F;
    list->AddRectFilled(ImVec2(layout.columnAt(0), layout.low.y), ImVec2(layout.columnAt(graph.memories), bottom), IM_COL32(0, 0, 0, 60));
    for (size_t r = 0; r < graph.resources.size(); ++r) {
        const Graph::Resource& resource = graph.resources[r];
        if (resource.memory == SIZE_MAX || resource.first == SIZE_MAX) continue;
        // What is needed after the frame lives to its end.
        const size_t last = resource.output ? graph.passes.size() - 1 : resource.last;
        const ImVec2 a(layout.columnAt(resource.memory) + inset, layout.top(resource.first) + 1),
            b(layout.columnAt(resource.memory) + layout.column - inset, layout.top(last) + layout.row - 1);
        const ImU32 colour = plotColour(r), faint = (colour & ~IM_COL32_A_MASK) | (r == pointed_ ? 0xE0000000U : 0x70000000U);
        list->AddRectFilled(a, b, faint, 3);
        if (layout.column < 6) continue;
        const float x = 0.5F * (a.x + b.x), radius = std::min(0.32F * (b.x - a.x), 4.0F);
        for (size_t p = resource.first; p <= resource.last; ++p) {
            if (graph.passes[p].culled) continue;
            const ImVec2 centre(x, layout.top(p) + 0.5F * layout.row);
            if (uses(graph.passes[p].writes, r)) {
                list->AddCircleFilled(centre, radius, IM_COL32(255, 255, 255, 230), 10);
            } else if (uses(graph.passes[p].reads, r)) {
                list->AddCircle(centre, radius, IM_COL32(255, 255, 255, 230), 10, 1.2F);
            }
        }
    }
}

void FrameGraphPanel::tellResource(const Graph& graph, size_t resource) const {
    const Graph::Resource& r = graph.resources[resource];
    ImGui::BeginTooltip();
    ImGui::TextUnformatted(r.name.c_str());
    ImGui::TextDisabled("%s %s, %s MB", sizeOf(r).c_str(), r.format.c_str(), megabytes(r.bytes).c_str());
    if (r.first != SIZE_MAX)
        ImGui::TextDisabled("from \"%s\" to \"%s\"", graph.passes[r.first].name.c_str(), graph.passes[r.last].name.c_str());
    std::string others;
    for (size_t k = 0; k < graph.resources.size(); ++k)
        if (k != resource && graph.resources[k].memory == r.memory && r.memory != SIZE_MAX)
            others += (others.empty() ? "" : ", ") + graph.resources[k].name;
    if (!others.empty()) ImGui::TextDisabled("shares memory with: %s", others.c_str());
    ImGui::EndTooltip();
}

void FrameGraphPanel::drawResources(const Graph& graph) {
    if (!ImGui::BeginTable("resources", 5, ImGuiTableFlags_SizingFixedFit | ImGuiTableFlags_RowBg)) return;
    ImGui::TableSetupColumn("resource", ImGuiTableColumnFlags_WidthStretch);
    for (const char* name : {"size", "format", "MB", "memory"}) ImGui::TableSetupColumn(name);
    ImGui::TableNextRow();
    for (const char* title : {"resource", "size", "format", "MB", "memory"}) {
        ImGui::TableNextColumn();
        ImGui::TextDisabled("%s", title);
    }
    for (const bool lent : {true, false})
        for (size_t k = 0; k < graph.resources.size(); ++k) {
            const Graph::Resource& r = graph.resources[k];
            if ((r.memory != SIZE_MAX) != lent) continue;
            ImGui::TableNextRow();
            ImGui::TableNextColumn();
            const ImVec2 low = ImGui::GetCursorScreenPos();
            const float side = 0.6F * ImGui::GetFontSize(), middle = low.y + 0.5F * ImGui::GetTextLineHeight();
            if (lent)
                ImGui::GetWindowDrawList()->AddRectFilled(ImVec2(low.x, middle - 0.5F * side), ImVec2(low.x + side, middle + 0.5F * side),
                                                          plotColour(k), 2);
            ImGui::SetCursorPosX(ImGui::GetCursorPosX() + side + 5);
            ImGui::TextUnformatted(r.name.c_str());
            if (ImGui::IsItemHovered()) {
                pointing_ = k;
                tellResource(graph, k);
            }
            ImGui::TableNextColumn();
            ImGui::TextUnformatted(sizeOf(r).c_str());
            ImGui::TableNextColumn();
            ImGui::TextUnformatted(r.format.c_str());
            ImGui::TableNextColumn();
            textRight(megabytes(r.bytes));
            ImGui::TableNextColumn();
            textRight(lent ? std::to_string(r.memory + 1) : r.imported ? "own" : "none");
        }
    ImGui::EndTable();
}

}  // namespace rivulet
