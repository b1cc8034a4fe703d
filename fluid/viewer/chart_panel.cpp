#include "fluid/viewer/chart_panel.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "engine/core/json.h"
#include "fluid/sim/methods/method.h"

namespace rivulet {

namespace {

// In heights of letters.
constexpr float kGutter = 3.9F, kBelow = 2.7F, kAbove = 1.45F;  // of what is written about the plot
constexpr float kNear = 0.65F;                                  // that a mouse may be beside a point
constexpr float kMark = 0.32F;                                  // a point's radius
constexpr double kLeastError = 1e-6;                            // what an axis of decades shows of none

std::string methodOf(const ChartRow& row) {
    const ChartSetting* setting = chartSettings().find(row.setting);
    return setting != nullptr ? setting->method : "";
}

// Each method has a shape of its own beside its colour.
void mark(ImDrawList* list, size_t method, const ImVec2& at, float radius, bool filled) {
    const ImU32 colour = plotColour(method);
    constexpr float kLine = 1.5F;
    switch (method % 4) {
        case 0:
            filled ? list->AddCircleFilled(at, radius, colour, 16) : list->AddCircle(at, radius, colour, 16, kLine);
            break;
        case 1: {
            const float r = 0.88F * radius;
            const ImVec2 a(at.x - r, at.y - r), b(at.x + r, at.y + r);
            filled ? list->AddRectFilled(a, b, colour) : list->AddRect(a, b, colour, 0, 0, kLine);
            break;
        }
        default: {
            const float r = 1.2F * radius, up = method % 4 == 2 ? 1.0F : -1.0F;
            const ImVec2 a(at.x, at.y - up * r), b(at.x + r, at.y + 0.7F * up * r), c(at.x - r, at.y + 0.7F * up * r);
            filled ? list->AddTriangleFilled(a, b, c, colour) : list->AddTriangle(a, b, c, colour, kLine);
        }
    }
}

void line(const char* name, const std::string& text) {
    ImGui::TextDisabled("%s", name);
    ImGui::SameLine(ImGui::GetFontSize() * 7);
    ImGui::PushTextWrapPos(ImGui::GetFontSize() * 30);
    ImGui::TextUnformatted(text.c_str());
    ImGui::PopTextWrapPos();
}

std::string seconds(double s) { return readableFigure(s, "s"); }
std::string readableCount(double n) { return readableFigure(n, ""); }

}  // namespace

const ChartSetting* settingOf(const FluidParams& params) {
    for (const ChartSetting& setting : chartSettings().rows) {
        if (params.method != setting.method || !setting.picked) continue;
        SceneFile scene;
        scene.fluid = params;
        applySetting(setting, scene);  // changes nothing but what settings name
        const auto own = [visit = methodOf(params).visit](FluidParams p) {
            return visit == nullptr ? std::string() : writeJson([&](ParamVisitor& v) { visit(p, v); });
        };
        if (scene.fluid.cfl == params.cfl && own(scene.fluid) == own(params)) return &setting;
    }
    return nullptr;
}

void ChartMeasured::add(double addedMs, double addedSeconds, double particles, int substeps, double avgCompression) {
    constexpr double kFades = 0.5;  // s simulated
    const double keep = std::exp(-addedSeconds / kFades);
    ms = keep * ms + addedMs;
    seconds = keep * seconds + addedSeconds;
    particleSteps = keep * particleSteps + particles * substeps;
    compression = keep * compression + avgCompression * addedSeconds;
}

const ChartRow* rowLike(const std::vector<ChartRow>& chart, std::string_view name, const ChartSetting* setting, std::string_view method,
                        double particles) {
    const auto nearest = [&](std::string_view of) {
        const ChartRow* best = nullptr;
        const auto off = [&](const ChartRow& row) { return std::abs(std::log(row.particles / std::max(particles, 1.0))); };
        for (const ChartRow& row : chart)
            if (row.name == name && row.setting == of && row.particles > 0 && (best == nullptr || off(row) < off(*best))) best = &row;
        return best;
    };
    const ChartRow* own = setting != nullptr ? nearest(setting->name) : nullptr;
    return own != nullptr ? own : nearest(method);
}

double broughtTo(const ChartRow& row, const ChartMeasured& measured) {
    return 1e-9 * measured.nsPerParticleStep() * row.particles * row.stepsPerSecond;
}

ChartPanel::ChartPanel() : chart_(readChart(builtInChart())) {
    const auto note = [](std::vector<std::string>& list, const std::string& name) {
        if (std::find(list.begin(), list.end(), name) == list.end()) list.push_back(name);
    };
    for (const ChartRow& row : chart_) {
        note(cases_, row.name);
        note(methods_, methodOf(row));
    }
    const auto moving = std::find(cases_.begin(), cases_.end(), "dam_break");
    case_ = moving != cases_.end() ? static_cast<size_t>(moving - cases_.begin()) : 0;
    const std::string_view csv = builtInChart();
    if (csv.starts_with("# ")) machine_ = csv.substr(2, csv.find('\n') - 2);
}

void ChartPanel::stepped(const FluidWorld& world, double ms, double seconds) {
    const FluidStats& stats = world.stats();
    measured_.add(ms, seconds, stats.particles, world.lastSubsteps(), stats.avgCompression);
}

double ChartPanel::errorOf(const ChartRow& row) const { return std::max(ofDensity_ ? row.compression : row.error, kLeastError); }

void ChartPanel::chooseCase(float width) {
    ImGui::SetNextItemWidth(0.4F * width);
    if (ImGui::BeginCombo("##case", cases_[case_].c_str())) {
        for (size_t k = 0; k < cases_.size(); ++k)
            if (ImGui::Selectable(cases_[k].c_str(), k == case_)) case_ = k;
        ImGui::EndCombo();
    }
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("the case that every setting was run on; rivulet validate runs it on this machine");
    ImGui::SameLine();
    if (ImGui::RadioButton("density", ofDensity_)) ofDensity_ = true;
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("mean compression over particles and time; every run measures it");
    ImGui::SameLine();
    if (ImGui::RadioButton("case error", !ofDensity_)) ofDensity_ = false;
    const auto row = std::find_if(chart_.begin(), chart_.end(), [&](const ChartRow& r) { return r.name == cases_[case_]; });
    if (ImGui::IsItemHovered() && row != chart_.end()) ImGui::SetTooltip("error of: %s", row->what.c_str());
}

std::string ChartPanel::captionOf(const Here& here, const std::string& name) {
    if (!(here.cost > 0)) return "none: this method was not run on the case";
    return fmt::format("density error {}, {} per\nsimulated second of {}", percentText(here.densityError), seconds(here.cost), name);
}

ChartPanel::Here ChartPanel::hereOf(const Session& session) const {
    const FluidParams& params = session.scene().fluid;
    const ChartRow* like =
        rowLike(chart_, cases_[case_], settingOf(params), params.method, static_cast<double>(session.world().stats().particles));
    return {like, like != nullptr ? broughtTo(*like, measured_) : 0, measured_.densityError()};
}

// Where each point and the run lie. The axes hold all of them.
void ChartPanel::place(const Session& session, vec2 low, vec2 size) {
    placed_.clear();
    double least[2] = {INFINITY, INFINITY}, largest[2] = {0, 0};
    const auto hold = [&](double cost, double error) {
        least[0] = std::min(least[0], cost);
        largest[0] = std::max(largest[0], cost);
        least[1] = std::min(least[1], error);
        largest[1] = std::max(largest[1], error);
    };
    for (const ChartRow& row : chart_)
        if (row.name == cases_[case_]) hold(row.wallPerSecond, errorOf(row));
    here_ = hereOf(session);
    const double cost = here_.cost, error = std::max(here_.densityError, kLeastError);
    if (cost > 0) hold(cost, ofDensity_ ? error : least[1]);
    cost_ = axisOf(least[0], largest[0], true);
    error_ = axisOf(least[1], largest[1], true);
    const auto at = [&](double c, double e) {
        return low + size * vec2(static_cast<float>(cost_.share(c)), 1 - static_cast<float>(error_.share(e)));
    };
    for (const ChartRow& row : chart_)
        if (row.name == cases_[case_]) placed_.push_back({&row, at(row.wallPerSecond, errorOf(row))});
    if (cost > 0) placed_.push_back({nullptr, at(cost, error)});
}

void ChartPanel::drawAxes(vec2 low, vec2 size) const {
    ImDrawList* list = ImGui::GetWindowDrawList();
    const float tall = ImGui::GetFontSize();
    const ImU32 grid = IM_COL32(255, 255, 255, 26), text = ImGui::GetColorU32(ImGuiCol_TextDisabled);
    list->AddRectFilled(ImVec2(low.x, low.y), ImVec2(low.x + size.x, low.y + size.y), ImGui::GetColorU32(ImGuiCol_FrameBg), 3);
    for (const double tick : error_.ticks(8)) {
        const float y = low.y + size.y * (1 - static_cast<float>(error_.share(tick)));
        list->AddLine(ImVec2(low.x, y), ImVec2(low.x + size.x, y), grid);
        const std::string label = fmt::format("{:g} %", 100 * tick);
        list->AddText(ImVec2(low.x - ImGui::CalcTextSize(label.c_str()).x - 4, y - 0.5F * tall), text, label.c_str());
    }
    for (const double tick : cost_.ticks(7)) {
        const float x = low.x + size.x * static_cast<float>(cost_.share(tick));
        list->AddLine(ImVec2(x, low.y), ImVec2(x, low.y + size.y), grid);
        const std::string label = seconds(tick);
        const float wide = ImGui::CalcTextSize(label.c_str()).x;
        list->AddText(ImVec2(std::min(x - 0.5F * wide, low.x + size.x - wide), low.y + size.y + 3), text, label.c_str());
    }
    const char* below = "cost: wall time per simulated second";
    list->AddText(ImVec2(low.x + 0.5F * (size.x - ImGui::CalcTextSize(below).x), low.y + size.y + tall + 5), text, below);
    list->AddText(ImVec2(low.x, low.y - tall - 3), text, ofDensity_ ? "density error" : "case error");
}

// A curve a method: its settings at the size that most were run at, from the cheapest on. Other sizes are hollow points.
void ChartPanel::drawCurves() const {
    ImDrawList* list = ImGui::GetWindowDrawList();
    std::vector<uint32_t> sizes;
    for (const Placed& p : placed_)
        if (p.row != nullptr) sizes.push_back(p.row->particles);
    uint32_t usual = 0;
    for (const uint32_t size : sizes)
        if (std::count(sizes.begin(), sizes.end(), size) > std::count(sizes.begin(), sizes.end(), usual)) usual = size;
    for (size_t m = 0; m < methods_.size(); ++m) {
        std::vector<const Placed*> own;
        for (const Placed& p : placed_)
            if (p.row != nullptr && p.row->particles == usual && methodOf(*p.row) == methods_[m]) own.push_back(&p);
        std::sort(own.begin(), own.end(), [](const Placed* a, const Placed* b) { return a->at.x < b->at.x; });
        for (size_t k = 1; k < own.size(); ++k)
            list->AddLine(ImVec2(own[k - 1]->at.x, own[k - 1]->at.y), ImVec2(own[k]->at.x, own[k]->at.y),
                          (plotColour(m) & ~IM_COL32_A_MASK) | 0x80000000U, 1.5F);
    }
    for (const Placed& p : placed_) {
        if (p.row == nullptr) continue;
        const auto m = static_cast<size_t>(std::find(methods_.begin(), methods_.end(), methodOf(*p.row)) - methods_.begin());
        mark(list, m, ImVec2(p.at.x, p.at.y), kMark * ImGui::GetFontSize(), p.row->particles == usual);
    }
}

// A cross where the run is; where its error is no figure that the run measures, its cost alone.
void ChartPanel::drawHere(const Session& session, vec2 low, vec2 size) const {
    if (placed_.empty() || placed_.back().row != nullptr) return;
    ImDrawList* list = ImGui::GetWindowDrawList();
    const vec2 at = placed_.back().at;
    const ImU32 white = IM_COL32(255, 255, 255, 235), faint = IM_COL32(255, 255, 255, 90);
    list->AddLine(ImVec2(at.x, low.y), ImVec2(at.x, low.y + size.y), faint);
    if (ofDensity_) {
        list->AddLine(ImVec2(low.x, at.y), ImVec2(low.x + size.x, at.y), faint);
        list->AddCircle(ImVec2(at.x, at.y), 7, white, 20, 2);
    }
    const char* text = "this run";
    const ImVec2 wide = ImGui::CalcTextSize(text);
    const float x = at.x + 10 + wide.x < low.x + size.x ? at.x + 10 : at.x - 10 - wide.x;
    const float y = ofDensity_ ? std::max(at.y - wide.y - 6, low.y + wide.y + 4) : low.y + size.y - wide.y - 4;
    list->AddRectFilled(ImVec2(x - 3, y - 1), ImVec2(x + wide.x + 3, y + wide.y + 1), IM_COL32(10, 14, 18, 200), 3);
    list->AddText(ImVec2(x, y), white, text);
    const ImVec2 mouse = ImGui::GetIO().MousePos;
    const bool over = mouse.x >= x - 3 && mouse.x <= x + wide.x + 3 && mouse.y >= y - 1 && mouse.y <= y + wide.y + 1;
    const bool onIt = ofDensity_ && glm::distance(vec2(mouse.x, mouse.y), at) < kNear * ImGui::GetFontSize();
    if (ImGui::IsItemHovered() && (over || onIt)) tellHere(session);
}

// How the place of "this run" was found.
void ChartPanel::tellHere(const Session& session) const {
    const FluidParams& params = session.scene().fluid;
    const ChartSetting* setting = settingOf(params);
    const double particles = session.world().stats().particles;
    const ChartRow* row = here_.row;
    if (row == nullptr) return;
    ImGui::BeginTooltip();
    ImGui::TextUnformatted("This run");
    line("method", setting != nullptr ? std::string(setting->name) : params.method + ", custom values");
    line("spacing", fmt::format("{:.4g} m, {} particles", params.spacing, readableCount(particles)));
    line("density",
         fmt::format("{} error: mean over particles and the last 0.5 s simulated, about", percentText(measured_.densityError())));
    line("cost", fmt::format("{} per simulated second, {:.3g} ns per particle and substep", seconds(measured_.wallPerSecond()),
                             measured_.nsPerParticleStep()));
    ImGui::Spacing();
    line("on the chart",
         fmt::format("{:.3g} ns x {} particles x {} substeps per simulated second of {} with {}: {}", measured_.nsPerParticleStep(),
                     readableCount(row->particles), readableCount(row->stepsPerSecond), row->name, row->setting, seconds(here_.cost)));
    line("reference", fmt::format("that run took {} on: {}", seconds(row->wallPerSecond), machine_));
    if (!ofDensity_) line("error", fmt::format("measured by the case only: {}", row->what));
    ImGui::EndTooltip();
}

double ChartPanel::spacingFor(const ChartRow& row, const Session& session) const {
    const double particles = session.world().stats().particles;
    return particles > 0 ? double{session.scene().fluid.spacing} * std::cbrt(particles / row.particles) : 0;
}

void ChartPanel::tellRow(const ChartRow& row, const Session& session, const SceneFile& draft) const {
    const ChartSetting* setting = chartSettings().find(row.setting);
    ImGui::BeginTooltip();
    ImGui::Text("%s: %s", setting->name, setting->doc);
    line("case", fmt::format("{}, {} particles, {:.3g} m apart", row.name, readableCount(row.particles), row.spacing));
    line("cost", seconds(row.wallPerSecond) + " per simulated second");
    line("density", percentText(row.compression) + " error");
    line("error", percentText(row.error) + ", " + row.what);
    ImGui::Spacing();
    if (draft.budget.frameMs > 0) {
        line("click", "no effect: the scene's budget picks the method; set budget.frameMs = 0 to choose it");
    } else {
        std::string what = fmt::format("fluid.method = {}", setting->method);
        for (const std::string& assignment : assignmentsOf(setting->assignments)) what += ", " + assignment;
        if (asMany_ && spacingFor(row, session) > 0) what += fmt::format(", fluid.spacing = {:.3g}", spacingFor(row, session));
        line("click", what + "; restarts the water");
    }
    ImGui::EndTooltip();
}

bool ChartPanel::take(const ChartRow& row, const Session& session, SceneFile& draft) const {
    if (draft.budget.frameMs > 0) return false;
    applySetting(*chartSettings().find(row.setting), draft);
    if (const double spacing = spacingFor(row, session); asMany_ && spacing > 0) draft.fluid.spacing = static_cast<float>(spacing);
    return true;
}

void ChartPanel::drawLegend(const Session& session, float width) {
    ImDrawList* list = ImGui::GetWindowDrawList();
    const float begin = ImGui::GetCursorPosX(), font = ImGui::GetFontSize();
    float used = 0;
    for (size_t m = 0; m < methods_.size(); ++m) {
        if (std::none_of(placed_.begin(), placed_.end(),
                         [&](const Placed& p) { return p.row != nullptr && methodOf(*p.row) == methods_[m]; }))
            continue;
        const float wide = 1.1F * font + ImGui::CalcTextSize(methods_[m].c_str()).x + 0.7F * font;
        const bool beside = used > 0 && used + wide <= width;
        if (beside) ImGui::SameLine(begin + used);
        used = beside ? used + wide : wide;
        const ImVec2 low = ImGui::GetCursorScreenPos();
        mark(list, m, ImVec2(low.x + 0.4F * font, low.y + 0.5F * ImGui::GetTextLineHeight()), kMark * font, true);
        list->AddText(ImVec2(low.x + 1.1F * font, low.y), ImGui::GetColorU32(ImGuiCol_Text), methods_[m].c_str());
        ImGui::Dummy(ImVec2(wide, ImGui::GetTextLineHeight()));
    }
    ImGui::TextDisabled("filled: the common size; hollow: coarser or finer");
    ImGui::Checkbox("a click also sets the number of particles", &asMany_);
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("sets the spacing so that this scene has as many particles as the point's case");
    const FluidParams& params = session.scene().fluid;
    const ChartSetting* setting = settingOf(params);
    ImGui::Spacing();
    line("this run", fmt::format("{}, spacing {:.3g} m",
                                 setting != nullptr ? std::string(setting->name) : params.method + ", custom values", params.spacing));
    line("circle", captionOf(here_, cases_[case_]));
    line("this scene", fmt::format("{} per simulated second", seconds(measured_.wallPerSecond())));
    line("measured on", machine_);
}

bool ChartPanel::draw(const Session& session, SceneFile& draft, float width, float height) {
    if (chart_.empty()) return false;
    chooseCase(width);
    const float rest = 11 * ImGui::GetTextLineHeightWithSpacing();
    const ImVec2 all(width, std::clamp(height - ImGui::GetFrameHeightWithSpacing() - rest, 160.0F, 0.9F * width));
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    const bool clicked = ImGui::InvisibleButton("chart", all);
    const bool hovered = ImGui::IsItemHovered();
    const float font = ImGui::GetFontSize();
    const vec2 low(corner.x + kGutter * font, corner.y + kAbove * font), size(all.x - kGutter * font - 4, all.y - (kBelow + kAbove) * font);
    place(session, low, size);
    drawAxes(low, size);
    ImGui::GetWindowDrawList()->PushClipRect(ImVec2(low.x - 6, low.y - 6), ImVec2(low.x + size.x + 6, low.y + size.y + 6), true);
    drawCurves();
    drawHere(session, low, size);
    ImGui::GetWindowDrawList()->PopClipRect();
    const vec2 mouse(ImGui::GetIO().MousePos.x, ImGui::GetIO().MousePos.y);
    const Placed* nearest = nullptr;
    for (const Placed& p : placed_)
        if (nearest == nullptr || glm::distance(p.at, mouse) < glm::distance(nearest->at, mouse)) nearest = &p;
    bool taken = false;
    if (hovered && nearest != nullptr && nearest->row != nullptr && glm::distance(nearest->at, mouse) < kNear * font) {
        ImGui::GetWindowDrawList()->AddCircle(ImVec2(nearest->at.x, nearest->at.y), 8, IM_COL32(255, 255, 255, 200), 20, 1.5F);
        tellRow(*nearest->row, session, draft);
        taken = clicked && take(*nearest->row, session, draft);
    }
    drawLegend(session, width);
    return taken;
}

}  // namespace rivulet
