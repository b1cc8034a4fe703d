#include "fluid/validate/chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "engine/core/assert.h"

namespace rivulet {

namespace {

// A case of the chart: assignments for a coarser and a finer size than that of `validate --quick`, and for all sizes.
struct ChartCase {
    const char* name;
    bool quick;
    const char *coarse, *fine;
    const char* all = "";
};
constexpr ChartCase kChartCases[] = {
    // Long enough for water that may sleep.
    {"hydrostatic", true, "fluid.spacing=0.0357142857", "fluid.spacing=0.0178571429", "duration=8"},
    {"dam_break", true, "fluid.spacing=0.00238125; fluid.box.max=0.3429,0.15,0.01190625; fluid.blocks.0.max=0.05715,0.1143,0.01190625",
     "fluid.spacing=0.00119062500; fluid.box.max=0.3429,0.15,0.005953125; fluid.blocks.0.max=0.05715,0.1143,0.005953125"},
    {"standing_wave", true, "fluid.spacing=0.025; fluid.box.max=1,0.8,0.125; fluid.blocks.0.max=1,0.5,0.125",
     "fluid.spacing=0.0125; fluid.box.max=1,0.8,0.0625; fluid.blocks.0.max=1,0.5,0.0625"},
    {"taylor_green", true, "fluid.spacing=0.0333333333; fluid.box.max=1,1,0.2666666664; fluid.blocks.0.max=1,1,0.2666666664",
     "fluid.spacing=0.02; fluid.box.max=1,1,0.16; fluid.blocks.0.max=1,1,0.16"},
    {"poiseuille", false,
     "fluid.spacing=3.3333333e-5; fluid.box.max=1.6666667e-4,1e-3,1.6666667e-4; fluid.blocks.0.max=1.6666667e-4,1e-3,1.6666667e-4",
     "fluid.spacing=2e-5; fluid.box.max=1.2e-4,1e-3,1.2e-4; fluid.blocks.0.max=1.2e-4,1e-3,1.2e-4"},
};
enum Size { kCoarse, kMiddle, kFine };

void add(std::vector<std::string>& to, std::string_view assignments) {
    for (std::string& each : assignmentsOf(assignments)) to.push_back(std::move(each));
}

struct Run {
    const ChartCase* of;
    const ChartSetting* setting;
    Size size;
};

// Default settings at all sizes, the others at the middle size. Quick: some settings, two sizes.
std::vector<Run> plannedRuns(const ChartRequest& request) {
    std::vector<Run> runs;
    for (const ChartCase& c : kChartCases) {
        const bool named = std::find(request.names.begin(), request.names.end(), c.name) != request.names.end();
        if (request.names.empty() ? request.quick && !c.quick : !named) continue;
        for (const Size size : {kCoarse, kMiddle, kFine})
            for (const ChartSetting& s : chartSettings().rows)
                if ((s.quick || !request.quick) && (size == kMiddle || (*s.assignments == '\0' && !(request.quick && size == kFine))))
                    runs.push_back({&c, &s, size});
    }
    return runs;
}

// The judged figure; null if the run gave none.
const Finding* judgedOf(const Outcome& outcome) {
    const auto found = std::find_if(outcome.findings.begin(), outcome.findings.end(), [](const Finding& f) { return f.tolerance; });
    return found == outcome.findings.end() ? nullptr : &*found;
}

// Quick: without the extreme numbers of corrections.
constexpr int kIterations[] = {1, 2, 4, 8, 16}, kStepCounts[] = {4, 8, 16};
std::span<const int> iterationsOf(const ChartRequest& request) {
    const std::span<const int> all(kIterations);
    return request.quick ? all.subspan(1, all.size() - 2) : all;
}

}  // namespace

std::vector<std::string> chartCases() {
    std::vector<std::string> names;
    for (const ChartCase& c : kChartCases) names.emplace_back(c.name);
    return names;
}

std::string_view chartAssignments(std::string_view name) {
    const auto* found = std::find_if(std::begin(kChartCases), std::end(kChartCases), [&](const ChartCase& c) { return name == c.name; });
    return found == std::end(kChartCases) ? "" : found->all;
}

void markFront(std::vector<ChartRow>& rows) {
    for (ChartRow& row : rows)
        row.onFront = std::none_of(rows.begin(), rows.end(), [&](const ChartRow& other) {
            return other.name == row.name && other.error <= row.error && other.wallPerSecond <= row.wallPerSecond &&
                   (other.error < row.error || other.wallPerSecond < row.wallPerSecond);
        });
}

namespace {

bool charts(const ChartRequest& request, const char* name) {
    return request.names.empty() || std::find(request.names.begin(), request.names.end(), name) != request.names.end();
}

constexpr const char* kViscousCase = "standing_wave";

// The settings that the numerical viscosity of pbf is measured with.
std::vector<ViscosityRow> plannedViscosity(const ChartRequest& request) {
    std::vector<ViscosityRow> rows;
    if (!charts(request, kViscousCase)) return rows;
    const std::span<const int> iterations = iterationsOf(request);
    rows.reserve(std::size(kStepCounts) * iterations.size());
    for (const int steps : kStepCounts)
        for (const int each : iterations) rows.push_back({.iterations = each, .stepsPerFrame = steps});
    return rows;
}

Result<ChartPoint> runSetting(const Run& run, CaseSettings settings, const std::string& what) {
    settings.method = run.setting->method;
    settings.quick = run.size == kMiddle;
    if (run.size != kMiddle) add(settings.assignments, run.size == kCoarse ? run.of->coarse : run.of->fine);
    add(settings.assignments, run.of->all);
    add(settings.assignments, run.setting->assignments);
    const Result<Outcome> outcome = physicsCases().find(run.of->name)->run(settings);
    ChartPoint point;
    if (!outcome) {
        if (run.size == kMiddle) point.refused = fmt::format("{}: {}", what, outcome.error().message);
        return point;
    }
    if (outcome->findings.empty()) {
        point.stopped = true;
        return point;
    }
    const Finding* f = judgedOf(*outcome);
    if (f == nullptr || !std::isfinite(f->error)) {
        point.refused = fmt::format("{}: the run gave no figure", what);
        return point;
    }
    point.row = {run.of->name,
                 f->what,
                 run.setting->name,
                 outcome->spacing,
                 outcome->particles,
                 f->error,
                 outcome->wallPerSecond,
                 outcome->sweepsPerSecond,
                 outcome->stepsPerSecond,
                 outcome->compression,
                 outcome->fastest,
                 false};
    return point;
}

Result<ChartPoint> runViscosity(const ViscosityRow& row, CaseSettings settings) {
    settings.method = "pbf";
    settings.quick = true;
    settings.assignments.push_back(fmt::format("fluid.pbf.iterations={}", row.iterations));
    settings.assignments.push_back(fmt::format("fluid.pbf.minSubsteps={}", row.stepsPerFrame));
    const Result<Outcome> outcome = physicsCases().find(kViscousCase)->run(settings);
    if (!outcome) return outcome.error();
    ChartPoint point;
    point.stopped = outcome->findings.size() < 2;
    if (!point.stopped)
        point.viscosity = {row.iterations, row.stepsPerFrame, outcome->findings[1].measured, outcome->findings[0].error,
                           outcome->wallPerSecond};
    return point;
}

}  // namespace

size_t chartPoints(const ChartRequest& request) { return plannedRuns(request).size() + plannedViscosity(request).size(); }

Result<ChartPoint> runChartPoint(const ChartRequest& request, size_t k) {
    const std::vector<Run> runs = plannedRuns(request);
    const std::vector<ViscosityRow> viscous = plannedViscosity(request);
    const size_t whole = runs.size() + viscous.size();
    ASSERT(k < whole, "chartPoints() is the number of points");
    const ViscosityRow* viscosity = k < runs.size() ? nullptr : &viscous[k - runs.size()];
    const std::string what = viscosity == nullptr ? fmt::format("{}, {}", runs[k].of->name, runs[k].setting->name)
                                                  : fmt::format("{}, pbf with {} corrections and {} steps a frame", kViscousCase,
                                                                viscosity->iterations, viscosity->stepsPerFrame);
    CaseSettings settings;  // hundreds of runs: their notices are dropped
    settings.device = request.device;
    settings.goOn = [&](double share) { return request.goOn((static_cast<double>(k) + share) / static_cast<double>(whole), what); };
    return viscosity == nullptr ? runSetting(runs[k], settings, what) : runViscosity(*viscosity, settings);
}

void addPoint(Chart& chart, const ChartPoint& point) {
    if (point.row) chart.rows.push_back(*point.row);
    if (point.viscosity) chart.viscosity.push_back(*point.viscosity);
    if (!point.refused.empty()) chart.refused.push_back(point.refused);
    chart.stopped = chart.stopped || point.stopped;
}

Result<Chart> runChart(const ChartRequest& request) {
    Chart chart;
    const size_t points = chartPoints(request);
    for (size_t k = 0; k < points && !chart.stopped; ++k) {
        const Result<ChartPoint> point = runChartPoint(request, k);
        if (!point) return point.error();
        addPoint(chart, *point);
    }
    markFront(chart.rows);
    return chart;
}

}  // namespace rivulet
