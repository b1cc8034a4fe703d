#include "engine/ui/graph_panel.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "engine/core/assert.h"

namespace rivulet {

namespace {

// In multiples of the font height.
constexpr float kGutter = 3.3F;                     // width for the numbers of an axis
constexpr float kLeastTall = 3.2F, kMostTall = 11;  // height of a plot

float toFloat(double v) { return static_cast<float>(v); }

// Removes points within a fraction of a pixel of the straight line between the remaining points. Points are ordered by x.
void straighten(std::vector<ImVec2>& line) {
    constexpr float kOff = 0.3F;  // px
    size_t kept = 0;              // index of the last point kept
    float steepest = INFINITY, flattest = -INFINITY;
    for (size_t k = 1; k < line.size(); ++k) {
        // Range of slopes from the last point kept that pass near all later points.
        const ImVec2 from = line[kept], to = line[k];
        const float run = std::max(to.x - from.x, 1.0e-3F), slope = (to.y - from.y) / run;
        if (slope > steepest || slope < flattest) {
            line[++kept] = line[k - 1];
            steepest = INFINITY;
            flattest = -INFINITY;
            --k;
            continue;
        }
        steepest = std::min(steepest, slope + kOff / run);
        flattest = std::max(flattest, slope - kOff / run);
    }
    if (line.empty()) return;
    if (line.size() > 1) line[++kept] = line.back();
    line.resize(kept + 1);
}

}  // namespace

GraphPanel::GraphPanel(std::vector<Graph> graphs) : graphs_(std::move(graphs)), views_(graphs_.size()) {
    for (const Graph& graph : graphs_) {
        first_.push_back(rings_.size());
        rings_.resize(rings_.size() + graph.series.size(), std::vector<double>(kSamples));
    }
}

void GraphPanel::add(double time, std::span<const double> values) {
    ASSERT(values.size() == rings_.size(), "one figure for each series of the graphs");
    if (filled_ > 0 && time < times_[at(0)]) clear();
    times_[next_] = time;
    for (size_t k = 0; k < rings_.size(); ++k) rings_[k][next_] = values[k];
    next_ = (next_ + 1) % kSamples;
    filled_ = std::min(filled_ + 1, kSamples);
}

void GraphPanel::clear() {
    next_ = filled_ = 0;
    for (View& view : views_) view = {};
}

void GraphPanel::show(std::string_view graph, bool yes) {
    for (Graph& each : graphs_)
        if (each.name == graph) each.shown = yes;
}

std::vector<GraphPanel::Sample> GraphPanel::samples(std::string_view graph, std::string_view series) const {
    std::vector<Sample> all;
    for (size_t g = 0; g < graphs_.size(); ++g)
        for (size_t k = 0; k < graphs_[g].series.size(); ++k)
            if (graphs_[g].name == graph && graphs_[g].series[k].name == series)
                for (size_t age = filled_; age-- > 0;) all.push_back({times_[at(age)], ringValue(first_[g] + k, age)});
    return all;
}

// Adapts the axis to the values of a graph: the shown axis moves smoothly to its target. The axis grows at once, and shrinks when the
// values use less than about half of it.
void GraphPanel::follow(size_t graph) {
    double least = INFINITY, largest = -INFINITY, positive = INFINITY;
    for (size_t k = 0; k < graphs_[graph].series.size(); ++k)
        for (size_t age = 0; age < filled_; ++age) {
            const double v = ringValue(first_[graph] + k, age);
            if (!std::isfinite(v)) continue;
            least = std::min(least, v);
            largest = std::max(largest, v);
            if (v > 0) positive = std::min(positive, v);
        }
    View& view = views_[graph];
    if (!(least <= largest)) return;
    constexpr double kSpans = 50, kNoLonger = 20;  // largest over smallest value: enter and leave the logarithmic axis
    const bool decades = graphs_[graph].decades && least >= 0 && largest > positive * (view.target.decades ? kNoLonger : kSpans);
    const PlotAxis fits = axisOf(decades ? positive : least, largest, decades);
    constexpr double kRoom = 0.45;
    const bool small = fits.high - fits.low < kRoom * (view.target.high - view.target.low);
    const bool inside = fits.low >= view.target.low - 1e-12 && fits.high <= view.target.high + 1e-12;
    if (!view.settled || decades != view.target.decades || !inside || small) view.target = fits;
    if (!view.settled || view.shown.decades != view.target.decades) view.shown = view.target;
    view.settled = true;
    constexpr double kGently = 0.1;  // s
    const double part = 1 - std::exp(-double{ImGui::GetIO().DeltaTime} / kGently);
    view.shown.low += part * (view.target.low - view.shown.low);
    view.shown.high += part * (view.target.high - view.shown.high);
    const double off = std::abs(view.shown.low - view.target.low) + std::abs(view.shown.high - view.target.high);
    if (off < 1e-3 * (view.target.high - view.target.low)) view.shown = view.target;
}

void GraphPanel::draw(float width, float height) {
    const float line = ImGui::GetTextLineHeightWithSpacing(), font = ImGui::GetFontSize();
    if (filled_ > 1) span_ = roundStep(times_[at(0)] - times_[at(filled_ - 1)]);
    pointing_ = -1;
    // Unfolded graphs share the height that headers and legends leave.
    size_t unfolded = 0, last = SIZE_MAX;
    float left = height - line;
    for (const Graph& graph : graphs_) {
        if (!graph.shown) continue;
        left -= ImGui::GetFrameHeightWithSpacing();
        if (!graph.unfolded) continue;
        ++unfolded;
        last = static_cast<size_t>(&graph - graphs_.data());
        left -= line * (graph.series.size() > 3 ? 2 : 1) + 2 * ImGui::GetStyle().ItemSpacing.y;
    }
    const float tall = std::clamp(left / static_cast<float>(std::max<size_t>(unfolded, 1)), kLeastTall * font, kMostTall * font);
    for (size_t g = 0; g < graphs_.size(); ++g) {
        Graph& graph = graphs_[g];
        if (!graph.shown) continue;
        ImGui::SetNextItemOpen(graph.unfolded, ImGuiCond_Once);
        const std::string title = graph.unit == "%" ? graph.name + ", %" : graph.name;  // other units are shown at the axis
        graph.unfolded = ImGui::CollapsingHeader((title + "###" + graph.name).c_str());
        if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", graph.doc.c_str());
        if (graph.unfolded) drawGraph(g, width, tall, g == last);
    }
    pointed_ = pointing_;
}

void GraphPanel::drawGraph(size_t graph, float width, float height, bool last) {
    follow(graph);
    const ImVec2 low = ImGui::GetCursorScreenPos();
    const float gutter = kGutter * ImGui::GetFontSize();
    const Place place{low.x + gutter, low.y + 2, std::max(width - gutter - 2, 20.0F), height - 2};
    ImGui::Dummy(ImVec2(width, height));
    const bool hovered = ImGui::IsItemHovered();
    const ImVec2 mouse = ImGui::GetIO().MousePos;
    if (hovered && mouse.x >= place.left) pointing_ = double{(mouse.x - place.left) / place.width};
    ImDrawList* list = ImGui::GetWindowDrawList();
    const ImVec2 a(place.left, place.top), b(place.left + place.width, place.top + place.height);
    list->AddRectFilled(a, b, ImGui::GetColorU32(ImGuiCol_FrameBg), 3);
    if (filled_ == 0) {
        list->AddText(ImVec2(a.x + 6, a.y + 4), ImGui::GetColorU32(ImGuiCol_TextDisabled), "no step has been simulated yet");
        return;
    }
    drawTimes(place, last);
    drawAxis(views_[graph], graphs_[graph].unit, place);
    list->PushClipRect(a, b, true);
    drawCurves(graph, place);
    list->PopClipRect();
    if (pointed_ >= 0) {
        const size_t age = pointedAge();
        const float x = place.left + place.width * shareOf(times_[at(age)]);
        list->AddLine(ImVec2(x, a.y), ImVec2(x, b.y), IM_COL32(255, 255, 255, 90));
        for (size_t k = 0; k < graphs_[graph].series.size(); ++k) {
            const double v = ringValue(first_[graph] + k, age);
            if (std::isfinite(v))
                list->AddCircleFilled(ImVec2(x, b.y - place.height * toFloat(views_[graph].shown.share(v))), 3, plotColour(k), 8);
        }
        if (hovered && mouse.x >= place.left) drawTip(graph, age);
    }
    if (last) ImGui::Dummy(ImVec2(width, 0.8F * ImGui::GetFontSize()));
    drawLegend(graph, width);
}

// Draws horizontal lines at round numbers, with the numbers in the gutter on the left.
void GraphPanel::drawAxis(const View& view, const std::string& unit, const Place& place) const {
    ImDrawList* list = ImGui::GetWindowDrawList();
    const float tall = ImGui::GetFontSize(), bottom = place.top + place.height;
    for (const double tick : view.target.ticks(std::max(1, static_cast<int>(place.height / (1.6F * tall))))) {
        const auto share = toFloat(view.shown.share(tick));
        if (share < -0.001F || share > 1.001F) continue;
        const float y = bottom - place.height * share;
        list->AddLine(ImVec2(place.left, y), ImVec2(place.left + place.width, y),
                      tick == 0 ? IM_COL32(255, 255, 255, 60) : IM_COL32(255, 255, 255, 26));
        std::string text = readableFigure(tick, unit);
        if (unit == "%") text = fmt::format("{:g}", tick);
        const float wide = ImGui::CalcTextSize(text.c_str()).x;
        const float at = std::clamp(y - 0.5F * tall, place.top - 2, bottom - tall + 2);
        list->AddText(ImVec2(place.left - wide - 4, at), ImGui::GetColorU32(ImGuiCol_TextDisabled), text.c_str());
    }
}

// Draws vertical lines at round times before now, with the times below the last graph.
void GraphPanel::drawTimes(const Place& place, bool told) const {
    ImDrawList* list = ImGui::GetWindowDrawList();
    const float bottom = place.top + place.height;
    const auto text = [&](float x, const std::string& what) {
        const float wide = ImGui::CalcTextSize(what.c_str()).x;
        const float left = std::min(x - 0.5F * wide, place.left + place.width - wide);
        list->AddText(ImVec2(left, bottom + 2), ImGui::GetColorU32(ImGuiCol_TextDisabled), what.c_str());
    };
    const double step = roundStep(span_ / 5);
    for (double ago = step; ago < 0.999 * span_; ago += step) {
        const float x = place.left + place.width * toFloat(1 - ago / span_);
        list->AddLine(ImVec2(x, place.top), ImVec2(x, bottom), IM_COL32(255, 255, 255, 14));
        if (told) text(x, "-" + readableFigure(ago, "s"));
    }
    if (told) text(place.left + place.width, "now");
}

// At most one point a pixel: of several, the one farthest from the previous point, so that peaks stay visible. Points on straight pieces
// are removed.
void GraphPanel::drawCurves(size_t graph, const Place& place) const {
    const View& view = views_[graph];
    const float bottom = place.top + place.height;
    std::vector<ImVec2> line;
    line.reserve(filled_);
    for (size_t k = 0; k < graphs_[graph].series.size(); ++k) {
        const auto flush = [&] {
            straighten(line);
            constexpr float kThick = 2;  // a whole number: ImGui draws it with half the vertices
            if (line.size() > 1)
                ImGui::GetWindowDrawList()->AddPolyline(line.data(), static_cast<int>(line.size()), plotColour(k), 0, kThick);
            line.clear();
        };
        for (size_t age = filled_; age-- > 0;) {
            const double v = ringValue(first_[graph] + k, age);
            if (!std::isfinite(v)) {
                flush();
                continue;
            }
            const ImVec2 p(place.left + place.width * shareOf(times_[at(age)]), bottom - place.height * toFloat(view.shown.share(v)));
            if (line.size() > 1 && p.x - line[line.size() - 2].x < 1.0F) {
                const float before = line[line.size() - 2].y;
                if (std::abs(p.y - before) > std::abs(line.back().y - before)) line.back().y = p.y;
            } else {
                line.push_back(p);
            }
        }
        flush();
    }
}

void GraphPanel::drawLegend(size_t graph, float width) const {
    ImDrawList* list = ImGui::GetWindowDrawList();
    const float side = 0.6F * ImGui::GetFontSize(), gap = ImGui::GetStyle().ItemSpacing.x;
    const float begin = ImGui::GetCursorPosX();
    float used = 0;
    for (size_t k = 0; k < graphs_[graph].series.size(); ++k) {
        const Series& series = graphs_[graph].series[k];
        const std::string figure = readableFigure(ringValue(first_[graph] + k, 0), graphs_[graph].unit);
        // Reserves the largest width of a figure, so that the next entry does not move.
        const float name = ImGui::CalcTextSize(series.name.c_str()).x, wide = side + 4 + name + 5 + ImGui::CalcTextSize("0.08888 %").x;
        if (k > 0 && used + gap + wide <= width) {
            ImGui::SameLine(begin + used + gap);
            used += gap;
        } else {
            used = 0;
        }
        used += wide;
        const ImVec2 low = ImGui::GetCursorScreenPos();
        const float middle = low.y + 0.5F * ImGui::GetTextLineHeight();
        list->AddRectFilled(ImVec2(low.x, middle - 0.5F * side), ImVec2(low.x + side, middle + 0.5F * side), plotColour(k), 2);
        list->AddText(ImVec2(low.x + side + 4, low.y), ImGui::GetColorU32(ImGuiCol_TextDisabled), series.name.c_str());
        list->AddText(ImVec2(low.x + side + 4 + name + 5, low.y), ImGui::GetColorU32(ImGuiCol_Text), figure.c_str());
        ImGui::Dummy(ImVec2(wide, ImGui::GetTextLineHeight()));
        if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", series.doc.c_str());
    }
}

// Returns the sample nearest to the mouse.
size_t GraphPanel::pointedAge() const {
    size_t best = 0;
    for (size_t age = 0; age < filled_; ++age)
        if (std::abs(double{shareOf(times_[at(age)])} - pointed_) < std::abs(double{shareOf(times_[at(best)])} - pointed_)) best = age;
    return best;
}

void GraphPanel::drawTip(size_t graph, size_t age) const {
    ImGui::BeginTooltip();
    ImGui::TextDisabled("%.3f s", times_[at(age)]);
    for (size_t k = 0; k < graphs_[graph].series.size(); ++k) {
        ImGui::TextColored(ImColor(plotColour(k)), "%s", graphs_[graph].series[k].name.c_str());
        ImGui::SameLine(ImGui::GetFontSize() * 8);
        ImGui::TextUnformatted(readableFigure(ringValue(first_[graph] + k, age), graphs_[graph].unit).c_str());
    }
    ImGui::EndTooltip();
}

}  // namespace rivulet
