#include "fluid/bridge/budget.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/core/assert.h"
#include "engine/core/json.h"

namespace rivulet {

namespace {

constexpr double kFrames = 60;                // a simulated second
constexpr int kWatched = 60;                  // frames: what a miss is judged by
constexpr double kHolds = 1.1;                // of what was asked for: a tenth more holds it
constexpr double kPlanned = 0.85;             // of the frame: the chart and a calibration are not that exact
constexpr double kFewest = 500;               // particles: fewer show no water
constexpr const char* kMoving = "dam_break";  // the case whose cost is a scene's: in the others water hardly moves
constexpr const char* kFree[] = {"hydrostatic", "dam_break", "standing_wave"};  // with a free surface, as scenes have

// The row of the case and setting with the most particles.
const ChartRow* rowOf(std::span<const ChartRow> chart, std::string_view name, const ChartSetting& setting) {
    const ChartRow* best = nullptr;
    for (const ChartRow& row : chart)
        if (row.name == name && row.setting == setting.name && (best == nullptr || row.particles > best->particles)) best = &row;
    return best;
}

// What a setting leaves of density errors, in the worst of the cases.
double densityErrorOf(std::span<const ChartRow> chart, const ChartSetting& setting) {
    double worst = 0;
    for (const char* name : kFree)
        if (const ChartRow* row = rowOf(chart, name, setting)) worst = std::max(worst, row->compression);
    return worst;
}

// A setting on top of what a scene gives.
void applySetting(const ChartSetting& setting, const FluidParams& given, SceneFile& scene) {
    scene.fluid.method = setting.method;
    scene.fluid.pbf = given.pbf;
    scene.fluid.dfsph = given.dfsph;
    scene.fluid.cfl = given.cfl;
    std::string_view rest = setting.assignments;
    while (!rest.empty()) {
        const size_t end = std::min(rest.find("; "), rest.size());
        const Status set = setParam(rest.substr(0, end), [&scene](ParamVisitor& v) { scene.visit(v); });
        ASSERT(set, "the chart's settings name Params");
        rest.remove_prefix(std::min(end + 2, rest.size()));
    }
}

std::string percent(double share) { return fmt::format("{:.2g} %", 100 * share); }

}  // namespace

std::optional<double> frameCost(std::span<const ChartRow> chart, std::span<const SweepCost> costs, const SceneSize& size,
                                const ChartSetting& setting, double spacing) {
    const ChartRow* row = rowOf(chart, kMoving, setting);
    const auto cost = std::find_if(costs.begin(), costs.end(), [&](const SweepCost& c) { return c.method == setting.method; });
    if (row == nullptr || cost == costs.end() || row->stepsPerSecond <= 0 || row->fastest <= 0) return std::nullopt;
    // Steps go by how many spacings the fastest goes in a frame, as in the case; never fewer than the setting's least.
    SceneFile scene;
    applySetting(setting, {}, scene);
    const int least = scene.fluid.method == "pbf"     ? scene.fluid.pbf.minSubsteps
                      : scene.fluid.method == "dfsph" ? scene.fluid.dfsph.minSubsteps
                                                      : 1;
    const double faster = size.fastest / spacing / (row->fastest / row->spacing);
    const double steps = std::max<double>(least, row->stepsPerSecond / kFrames * faster);
    const double particles = size.particlesAt * std::pow(size.spacing / spacing, 3);
    return 1e-6 * cost->ns * particles * steps * row->sweepsPerSecond / row->stepsPerSecond;
}

std::optional<BudgetPick> pickSetting(std::span<const ChartRow> chart, std::span<const SweepCost> costs, const SceneSize& size,
                                      const BudgetParams& budget) {
    std::optional<BudgetPick> best;
    const auto better = [](const BudgetPick& a, const BudgetPick& b) {
        if (a.holdsError != b.holdsError) return a.holdsError;
        if (!a.holdsError && a.densityError != b.densityError) return a.densityError < b.densityError;
        if (a.spacing != b.spacing) return a.spacing < b.spacing;
        return a.frameMs < b.frameMs;
    };
    const double coarsest = std::max(size.finest, size.spacing * std::cbrt(size.particlesAt / kFewest));
    for (const ChartSetting& setting : chartSettings().rows) {
        BudgetPick pick{.setting = &setting, .spacing = size.finest, .densityError = densityErrorOf(chart, setting)};
        constexpr double kFiner = 1.02;
        for (;; pick.spacing = std::min(kFiner * pick.spacing, coarsest)) {
            const std::optional<double> ms = frameCost(chart, costs, size, setting, pick.spacing);
            if (!ms) break;
            pick.frameMs = *ms;
            pick.holdsFrame = *ms <= kPlanned * double{budget.frameMs};
            if (pick.holdsFrame || pick.spacing >= coarsest) break;
        }
        if (pick.frameMs <= 0) continue;
        pick.holdsError = pick.densityError <= double{budget.maxDensityError};
        pick.particles = size.particlesAt * std::pow(size.spacing / pick.spacing, 3);
        if (!best || better(pick, *best)) best = pick;
    }
    return best;
}

Budget::Budget(const SceneFile& scene, std::vector<ChartRow> chart, std::vector<SweepCost> costs, const SceneSize& size,
               const BudgetPick& pick)
    : budget_(scene.budget), given_(scene.fluid), chart_(std::move(chart)), costs_(std::move(costs)), size_(size), pick_(pick) {}

bool Budget::frame(double ms, double densityError, std::string& sentence) {
    sentence.clear();
    ms_ += ms;
    error_ += densityError;
    allMs_ += ms;
    allError_ += densityError;
    ++allFrames_;
    if (++frames_ < kWatched) return false;
    const double meanMs = ms_ / frames_, meanError = error_ / frames_;
    ms_ = error_ = 0;
    frames_ = 0;
    worstMs_ = std::max(worstMs_, meanMs);
    worstError_ = std::max(worstError_, meanError);
    const bool late = meanMs > kHolds * double{budget_.frameMs}, off = meanError > kHolds * double{budget_.maxDensityError};
    return (late || off) && again(meanMs, meanError, sentence);
}

// Another setting of the same method, as far as what was measured lets one hope: costs and errors go by the chart, from what they are now.
bool Budget::again(double ms, double densityError, std::string& sentence) {
    missed_.insert(pick_.setting);
    const double cost = frameCost(chart_, costs_, size_, *pick_.setting, pick_.spacing).value_or(ms),
                 error = std::max(densityErrorOf(chart_, *pick_.setting), 1e-9);
    BudgetPick best;
    for (const ChartSetting& setting : chartSettings().rows) {
        if (missed_.contains(&setting) || std::string_view(setting.method) != pick_.setting->method) continue;
        const std::optional<double> other = frameCost(chart_, costs_, size_, setting, pick_.spacing);
        if (!other) continue;
        BudgetPick pick{
            &setting, pick_.spacing, pick_.particles, ms * *other / cost, densityError * densityErrorOf(chart_, setting) / error,
            true,     true};
        if (pick.frameMs > double{budget_.frameMs} || pick.densityError > double{budget_.maxDensityError}) continue;
        if (best.setting == nullptr || pick.frameMs < best.frameMs) best = pick;
    }
    const std::string now =
        fmt::format("with {} a frame takes {:.3g} ms, {:.3g} were asked for, and density is {} off, {} was allowed", pick_.setting->name,
                    ms, budget_.frameMs, percent(densityError), percent(double{budget_.maxDensityError}));
    if (best.setting != nullptr) {
        sentence = fmt::format("budget: {}: {} from now on", now, best.setting->name);
        pick_ = best;
        ++repicked_;
        return true;
    }
    // What remains is fixed: fewer particles. Cost goes by the cube of the spacing, and by steps.
    const double coarser = pick_.spacing * std::pow(std::max(ms / (kPlanned * double{budget_.frameMs}), 1.0), 0.25);
    why_ =
        ms > kHolds * double{budget_.frameMs}
            ? fmt::format(
                  "{}: no other setting of {} promises to hold both, and particles are not changed in a run: start again with "
                  "budget.finest = {:.3g}, or allow more",
                  now, pick_.setting->method, coarser)
            : fmt::format("{}: no other setting of {} promises to hold both: start again with a budget.finest above {:.3g}, or allow more",
                          now, pick_.setting->method, pick_.spacing);
    if (!saidWhy_) sentence = "budget: " + why_;
    saidWhy_ = true;
    return false;
}

std::string Budget::report() const {
    std::string text =
        fmt::format("  budget of {:.3g} ms a frame and {} of density: {} ({}), {:.3g} m apart, about {:.0f} particles\n", budget_.frameMs,
                    percent(double{budget_.maxDensityError}), pick_.setting->name, pick_.setting->doc, pick_.spacing, pick_.particles);
    text += fmt::format("    expected {:.3g} ms and {}", pick_.frameMs, percent(pick_.densityError));
    if (repicked_ > 0) text += fmt::format(", picked anew {} times", repicked_);
    if (allFrames_ == 0) return text + "\n";
    const double worstMs = std::max(worstMs_, frames_ < kWatched / 2 ? 0 : ms_ / frames_),
                 worstError = std::max(worstError_, frames_ < kWatched / 2 ? 0 : error_ / frames_);
    const bool held = worstMs <= kHolds * double{budget_.frameMs} && worstError <= kHolds * double{budget_.maxDensityError};
    text += fmt::format("; measured over {} frames {:.3g} ms and {}, in the worst second {:.3g} ms and {}: {}\n", allFrames_,
                        allMs_ / allFrames_, percent(allError_ / allFrames_), worstMs, percent(worstError), held ? "held" : "not held");
    if (!why_.empty()) text += fmt::format("    {}\n", why_);
    return text;
}

void Budget::apply(SceneFile& scene) const { applySetting(*pick_.setting, given_, scene); }

}  // namespace rivulet
