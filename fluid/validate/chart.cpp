#include "fluid/validate/chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

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

Result<Chart> runChart(const ChartRequest& request) {
    Chart chart;
    const std::vector<Run> runs = plannedRuns(request);
    const bool wave =
        request.names.empty() || std::find(request.names.begin(), request.names.end(), "standing_wave") != request.names.end();
    const size_t viscous = wave ? iterationsOf(request).size() * std::size(kStepCounts) : 0, whole = runs.size() + viscous;
    size_t done = 0;
    CaseSettings settings;
    settings.device = request.device;
    // Hundreds of runs: their notices are dropped.
    const auto onWay = [&](const std::string& what) {
        settings.goOn = [&request, done, whole, what](double share) {
            return request.goOn((static_cast<double>(done) + share) / static_cast<double>(whole), what);
        };
    };
    for (const Run& run : runs) {
        settings.method = run.setting->method;
        settings.assignments.clear();
        settings.quick = run.size == kMiddle;
        if (run.size != kMiddle) add(settings.assignments, run.size == kCoarse ? run.of->coarse : run.of->fine);
        add(settings.assignments, run.of->all);
        add(settings.assignments, run.setting->assignments);
        const std::string what = fmt::format("{}, {}", run.of->name, run.setting->name);
        onWay(what);
        const Result<Outcome> outcome = physicsCases().find(run.of->name)->run(settings);
        ++done;
        if (!outcome) {
            if (run.size == kMiddle) chart.refused.push_back(fmt::format("{}: {}", what, outcome.error().message));
            continue;
        }
        if (outcome->findings.empty()) {
            chart.stopped = true;
            return chart;
        }
        const Finding* f = judgedOf(*outcome);
        if (f == nullptr || !std::isfinite(f->error)) {
            chart.refused.push_back(fmt::format("{}: the run gave no figure", what));
            continue;
        }
        chart.rows.push_back({run.of->name, f->what, run.setting->name, outcome->spacing, outcome->particles, f->error,
                              outcome->wallPerSecond, outcome->sweepsPerSecond, outcome->stepsPerSecond, outcome->compression,
                              outcome->fastest, false});
    }
    markFront(chart.rows);
    settings.quick = true;
    for (const int steps : kStepCounts)
        for (const int iterations : iterationsOf(request)) {
            if (!wave) break;
            settings.method = "pbf";
            settings.assignments.clear();
            settings.assignments.push_back(fmt::format("fluid.pbf.iterations={}", iterations));
            settings.assignments.push_back(fmt::format("fluid.pbf.minSubsteps={}", steps));
            onWay(fmt::format("standing_wave, pbf with {} corrections and {} steps a frame", iterations, steps));
            const Result<Outcome> outcome = physicsCases().find("standing_wave")->run(settings);
            ++done;
            if (!outcome) return outcome.error();
            if (outcome->findings.size() < 2) {
                chart.stopped = true;
                return chart;
            }
            chart.viscosity.push_back(
                {iterations, steps, outcome->findings[1].measured, outcome->findings[0].error, outcome->wallPerSecond});
        }
    return chart;
}

}  // namespace rivulet
