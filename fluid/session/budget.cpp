#include "fluid/session/budget.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "engine/core/assert.h"
#include "engine/core/json.h"
#include "fluid/session/session.h"
#include "fluid/sim/methods/method.h"

namespace rivulet {

namespace {

constexpr double kHolds = 1.1;                // a limit counts as held up to a tenth above it
constexpr double kPlanned = 0.85;             // share of the frame that is planned: chart and calibration are not exact
constexpr double kFewest = 500;               // particles: fewer do not look like water
constexpr const char* kMoving = "dam_break";  // the case that scenes are compared with: in the others water hardly moves
constexpr const char* kFree[] = {"hydrostatic", "dam_break", "standing_wave"};  // with a free surface, as scenes have

// The row of the case and setting, at the size with the most settings.
const ChartRow* rowOf(std::span<const ChartRow> chart, std::string_view name, const ChartSetting& setting) {
    std::map<uint32_t, int> runs;
    for (const ChartRow& row : chart)
        if (row.name == name) ++runs[row.particles];
    const ChartRow* best = nullptr;
    for (const ChartRow& row : chart)
        if (row.name == name && row.setting == setting.name && (best == nullptr || runs[row.particles] > runs[best->particles]))
            best = &row;
    return best;
}

// The compression of a setting, in the worst of the cases.
double densityErrorOf(std::span<const ChartRow> chart, const ChartSetting& setting) {
    double worst = 0;
    for (const char* name : kFree)
        if (const ChartRow* row = rowOf(chart, name, setting)) worst = std::max(worst, row->compression);
    return worst;
}

}  // namespace

double SceneSize::particles(double at) const {
    const double all = particlesAt * std::pow(spacing / at, 3);
    return most > 0 ? std::min(all, most) : all;
}

void applySetting(const ChartSetting& setting, SceneFile& scene) {
    const FluidParams plain;
    FluidParams& p = scene.fluid;
    p.method = setting.method;
    p.cfl = plain.cfl;
    p.pbf.iterations = plain.pbf.iterations;
    p.pbf.tolerance = plain.pbf.tolerance;  // it would take the place of iterations
    p.pbf.reach = plain.pbf.reach;
    p.pbf.minSubsteps = plain.pbf.minSubsteps;
    p.dfsph.tolerance = plain.dfsph.tolerance;
    p.dfsph.reach = plain.dfsph.reach;
    p.dfsph.minSubsteps = plain.dfsph.minSubsteps;
    for (const std::string& assignment : assignmentsOf(setting.assignments)) {
        const Status set = setParam(assignment, [&scene](ParamVisitor& v) { scene.visit(v); });
        ASSERT(set, "the chart's settings name Params");
    }
}

std::optional<double> frameCost(std::span<const ChartRow> chart, std::span<const SweepCost> costs, const SceneSize& size,
                                const ChartSetting& setting, double spacing) {
    const ChartRow* row = rowOf(chart, kMoving, setting);
    const auto cost = std::find_if(costs.begin(), costs.end(), [&](const SweepCost& c) { return c.method == setting.method; });
    if (row == nullptr || cost == costs.end() || row->stepsPerSecond <= 0 || row->fastest <= 0) return std::nullopt;
    SceneFile scene;
    applySetting(setting, scene);
    const FluidParams& p = scene.fluid;
    const int least = methodOf(p).leastSubsteps(p);
    const double faster = size.fastest / spacing / (row->fastest / row->spacing);
    const double steps = std::max<double>(least, row->stepsPerSecond / kFramesPerSecond * faster);
    return 1e-6 * cost->ns * size.particles(spacing) * steps * row->sweepsPerSecond / row->stepsPerSecond;
}

std::optional<BudgetPick> pickSetting(std::span<const ChartRow> chart, std::span<const SweepCost> costs, const SceneSize& size,
                                      const BudgetParams& budget) {
    if (size.particlesAt <= 0) return std::nullopt;
    std::optional<BudgetPick> best;
    const auto better = [](const BudgetPick& a, const BudgetPick& b) {
        if (a.holdsError != b.holdsError) return a.holdsError;
        if (!a.holdsError && a.densityError != b.densityError) return a.densityError < b.densityError;
        if (a.spacing != b.spacing) return a.spacing < b.spacing;
        return a.frameMs < b.frameMs;
    };
    const double coarsest = std::max(size.finest, size.spacing * std::cbrt(size.particlesAt / kFewest));
    for (const ChartSetting& setting : chartSettings().rows) {
        if (!setting.picked) continue;
        BudgetPick pick{.setting = &setting, .spacing = size.finest, .densityError = densityErrorOf(chart, setting)};
        std::optional<double> ms = frameCost(chart, costs, size, setting, pick.spacing);
        if (!ms) continue;
        const double planned = kPlanned * double{budget.frameMs};
        constexpr double kCoarser = 1.02;
        while (*ms > planned && pick.spacing < coarsest) {
            pick.spacing = std::min(kCoarser * pick.spacing, coarsest);
            ms = frameCost(chart, costs, size, setting, pick.spacing);
        }
        pick.frameMs = *ms;
        pick.holdsFrame = *ms <= planned;
        pick.holdsError = pick.densityError <= double{budget.maxDensityError};
        pick.particles = size.particles(pick.spacing);
        if (!best || better(pick, *best)) best = pick;
    }
    return best;
}

Budget::Budget(const BudgetParams& budget, std::vector<ChartRow> chart, std::vector<SweepCost> costs, const SceneSize& size,
               const BudgetPick& pick)
    : budget_(budget), chart_(std::move(chart)), costs_(std::move(costs)), size_(size), pick_(pick) {}

double Budget::Mean::frameMs() const { return seconds > 0 ? ms / (kFramesPerSecond * seconds) : 0; }

bool Budget::holds(double ms, double densityError) const {
    return ms <= kHolds * double{budget_.frameMs} && densityError <= kHolds * double{budget_.maxDensityError};
}

bool Budget::frame(double ms, double seconds, double densityError, std::string& sentence) {
    sentence.clear();
    for (Mean* m : {&second_, &all_}) {
        m->ms += ms;
        m->error += densityError * seconds;
        m->seconds += seconds;
    }
    if (second_.seconds < 1 - 1e-6) return false;
    const double meanMs = second_.frameMs(), meanError = second_.densityError();
    second_ = {};
    ++secondsDone_;
    worstMs_ = std::max(worstMs_, meanMs);
    worstError_ = std::max(worstError_, meanError);
    return !holds(meanMs, meanError) && again(meanMs, meanError, sentence);
}

// Picks another setting of the same method that should hold both limits: measured cost and error, scaled by the chart's ratios.
bool Budget::again(double ms, double densityError, std::string& sentence) {
    missed_.insert(pick_.setting);
    const double cost = frameCost(chart_, costs_, size_, *pick_.setting, pick_.spacing).value_or(ms),
                 error = std::max(densityErrorOf(chart_, *pick_.setting), 1e-9);
    BudgetPick best;
    for (const ChartSetting& setting : chartSettings().rows) {
        if (!setting.picked || missed_.contains(&setting) || std::string_view(setting.method) != pick_.setting->method) continue;
        const std::optional<double> other = frameCost(chart_, costs_, size_, setting, pick_.spacing);
        if (!other) continue;
        BudgetPick pick = pick_;
        pick.setting = &setting;
        pick.frameMs = ms * *other / cost;
        pick.densityError = densityError * densityErrorOf(chart_, setting) / error;
        if (pick.frameMs > double{budget_.frameMs} || pick.densityError > double{budget_.maxDensityError}) continue;
        if (best.setting == nullptr || pick.frameMs < best.frameMs) best = pick;
    }
    const std::string now =
        fmt::format("with {} a frame takes {:.3g} ms (limit {:.4g}) and density has an error of {} (limit {})", pick_.setting->name, ms,
                    budget_.frameMs, percentText(densityError), percentText(double{budget_.maxDensityError}));
    if (best.setting != nullptr) {
        sentence = fmt::format("budget: {}: {} from now on", now, best.setting->name);
        pick_ = best;
        ++repicked_;
        return true;
    }
    // Only fixed values remain. Cost scales with the cube of the spacing, and with the number of steps.
    const double coarser = pick_.spacing * std::pow(std::max(ms / (kPlanned * double{budget_.frameMs}), 1.0), 0.25);
    const bool reported = !why_.empty();
    why_ = fmt::format("{}: no other setting of {} is expected to hold both, and method and spacing cannot change during a run: {}", now,
                       pick_.setting->method,
                       ms > kHolds * double{budget_.frameMs}
                           ? fmt::format("restart with budget.finest = {:.3g}, or raise the limit", coarser)
                           : "restart with a smaller budget.maxDensityError, which picks a stricter setting");
    if (!reported) sentence = "budget: " + why_;
    return false;
}

std::string Budget::report() const {
    std::string text =
        fmt::format("  budget of {:.4g} ms per frame and {} of density: {} ({}), {:.3g} m apart, about {:.0f} particles\n", budget_.frameMs,
                    percentText(double{budget_.maxDensityError}), pick_.setting->name, pick_.setting->doc, pick_.spacing, pick_.particles);
    text += fmt::format("    expected {:.3g} ms and {}", pick_.frameMs, percentText(pick_.densityError));
    if (repicked_ > 0) text += repicked_ == 1 ? ", picked again once" : fmt::format(", picked again {} times", repicked_);
    if (all_.seconds <= 0) return text + "\n";
    text += fmt::format("; measured over {:.3g} s {:.3g} ms and {}", all_.seconds, all_.frameMs(), percentText(all_.densityError()));
    const bool whole = secondsDone_ > 0;
    if (whole) text += fmt::format(", in the worst second {:.3g} ms and {}", worstMs_, percentText(worstError_));
    const bool held = whole ? holds(worstMs_, worstError_) : holds(all_.frameMs(), all_.densityError());
    text += fmt::format(": {}\n", held ? "held" : "not held");
    if (!why_.empty()) text += fmt::format("    {}\n", why_);
    return text;
}

}  // namespace rivulet
