// Writes a chart: a table, plots, and a page that explains them.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>

#include "engine/core/file.h"
#include "fluid/validate/chart.h"

namespace rivulet {

namespace {

std::string cost(double wallPerSecond) { return fmt::format("{:.2g} s", wallPerSecond); }

std::vector<std::string> caseNames(const Chart& chart) {
    std::vector<std::string> names;
    for (const ChartRow& row : chart.rows)
        if (std::find(names.begin(), names.end(), row.name) == names.end()) names.push_back(row.name);
    return names;
}

std::vector<ChartRow> rowsOf(const Chart& chart, const std::string& name) {
    std::vector<ChartRow> rows;
    std::copy_if(chart.rows.begin(), chart.rows.end(), std::back_inserter(rows), [&](const ChartRow& r) { return r.name == name; });
    std::sort(rows.begin(), rows.end(), [](const ChartRow& a, const ChartRow& b) { return a.wallPerSecond < b.wallPerSecond; });
    return rows;
}

std::string methodOf(const ChartRow& row) { return chartSettings().find(row.setting)->method; }

Plot plotOf(const std::vector<ChartRow>& rows) {
    Plot plot{rows.front().name + ": " + rows.front().what, "wall seconds per simulated second", "error", {}, true, true};
    constexpr double kLeast = 1e-5;  // a logarithmic axis has no 0
    std::map<std::string, Curve> methods;
    Curve front{"Pareto front", true, {}};
    for (const ChartRow& row : rows) {
        const glm::dvec2 at(row.wallPerSecond, std::max(row.error, kLeast));
        Curve& curve = methods[methodOf(row)];
        curve.name = methodOf(row);
        curve.line = false;
        curve.points.push_back(at);
        if (row.onFront) front.points.push_back(at);
    }
    for (const auto& [name, curve] : methods) plot.curves.push_back(curve);
    plot.curves.push_back(front);
    return plot;
}

// The cheapest row with at most this error; `rows` are sorted by cost.
const ChartRow* cheapest(const std::vector<ChartRow>& rows, double error) {
    const auto found = std::find_if(rows.begin(), rows.end(), [&](const ChartRow& r) { return r.error <= error; });
    return found == rows.end() ? nullptr : &*found;
}

std::string bestOf(const std::vector<ChartRow>& rows) {
    const ChartRow& best =
        *std::min_element(rows.begin(), rows.end(), [](const ChartRow& a, const ChartRow& b) { return a.error < b.error; });
    std::string text = fmt::format("Best: **{}** with {} particles, error {}, {} per simulated second.", best.setting, best.particles,
                                   percentText(best.error), cost(best.wallPerSecond));
    const ChartRow* last = nullptr;
    for (const double within : {0.2, 0.1, 0.05, 0.02, 0.01}) {
        const ChartRow* row = cheapest(rows, within);
        if (row == nullptr) {
            text += fmt::format(" No setting comes within {}.", percentText(within));
            break;
        }
        if (row != last)
            text += fmt::format(" Within {}: **{}**, {} particles, {}.", percentText(within), row->setting, row->particles,
                                cost(row->wallPerSecond));
        last = row;
    }
    return text;
}

// Methods with default settings at the middle size: cost and error of each, case by case.
std::string needs(const Chart& chart) {
    std::string text =
        "## Choosing a method\n\nThe Pareto front of a case is the set of rows for which no other row is both cheaper and more "
        "accurate.\n\n| method | rows on the front | error over the best, median | cost over the cheapest, median | compression |\n| --- | "
        "--- | --- | --- | --- |\n";
    std::map<std::string, std::vector<double>> errorRatios, costRatios, compressions;
    std::map<std::string, int> front;
    for (const std::string& name : caseNames(chart)) {
        const std::vector<ChartRow> rows = rowsOf(chart, name);
        std::vector<const ChartRow*> own;  // one particle count: the one that most settings were run at
        std::map<uint32_t, int> counts;
        for (const ChartRow& r : rows) ++counts[r.particles];
        const auto most = std::max_element(counts.begin(), counts.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
        for (const ChartRow& r : rows) {
            front[methodOf(r)] += r.onFront ? 1 : 0;
            if (r.particles == most->first && *chartSettings().find(r.setting)->assignments == '\0') own.push_back(&r);
        }
        double least = 1e300, fastest = 1e300;
        for (const ChartRow* r : own) {
            least = std::min(least, r->error);
            fastest = std::min(fastest, r->wallPerSecond);
        }
        for (const ChartRow* r : own) {
            errorRatios[methodOf(*r)].push_back(r->error / least);
            costRatios[methodOf(*r)].push_back(r->wallPerSecond / fastest);
            compressions[methodOf(*r)].push_back(r->compression);
        }
    }
    const auto median = [](std::vector<double> of) {
        std::sort(of.begin(), of.end());
        return of.empty() ? 0 : of[of.size() / 2];
    };
    std::string accurate, cheap, stiff;
    double leastError = 1e300, leastCost = 1e300, leastCompression = 1e300;
    for (const auto& [method, all] : errorRatios) {
        const double w = median(all), d = median(costRatios[method]), c = median(compressions[method]);
        text += fmt::format("| {} | {} | {:.2g} | {:.2g} | {} |\n", method, front[method], w, d, percentText(c));
        if (w < leastError) leastError = w, accurate = method;
        if (d < leastCost) leastCost = d, cheap = method;
        if (c < leastCompression) leastCompression = c, stiff = method;
    }
    return text + fmt::format(
                      "\n- For accurate figures: **{}**.\n- For the most particles per frame: **{}**.\n- For the least change of volume: "
                      "**{}**.\n",
                      accurate, cheap, stiff);
}

std::string tableOf(const std::vector<ChartRow>& rows) {
    std::string text =
        "| setting | particles | error | s per simulated s | sweeps per simulated s | steps per simulated s | compression | |\n| --- | --- "
        "| --- | --- "
        "| --- | --- | --- | --- |\n";
    for (const ChartRow& r : rows)
        text += fmt::format("| {} | {} | {} | {:.3g} | {:.4g} | {:.4g} | {} | {} |\n", r.setting, r.particles, percentText(r.error),
                            r.wallPerSecond, r.sweepsPerSecond, r.stepsPerSecond, percentText(r.compression), r.onFront ? "front" : "");
    return text;
}

std::string viscosityPage(const Chart& chart) {
    if (chart.viscosity.empty()) return {};
    const auto [least, most] = std::minmax_element(chart.viscosity.begin(), chart.viscosity.end(),
                                                   [](const auto& a, const auto& b) { return a.viscosity < b.viscosity; });
    std::string text = fmt::format(
        "## Numerical viscosity of pbf\n\nThe standing wave decays as if the water had this viscosity; the viscosity set is 1e-6 m^2/s. "
        "Over the numbers of corrections per step and of steps per frame it is least with {} corrections and {} steps at least ({:.2g} "
        "m^2/s), most with {} and {} ({:.2g}).\n\n![viscosity against corrections](pbf_viscosity.svg)\n\n| corrections | least steps per "
        "frame | viscosity, m^2/s | error of the period | s per simulated s |\n| --- | --- | --- | --- | --- |\n",
        least->iterations, least->stepsPerFrame, least->viscosity, most->iterations, most->stepsPerFrame, most->viscosity);
    for (const ViscosityRow& r : chart.viscosity)
        text += fmt::format("| {} | {} | {:.3g} | {} | {:.3g} |\n", r.iterations, r.stepsPerFrame, r.viscosity, percentText(r.periodError),
                            r.wallPerSecond);
    return text;
}

Plot viscosityPlot(const Chart& chart) {
    Plot plot{"pbf: viscosity of the standing wave", "corrections per step", "m^2/s", {}, true, true};
    std::map<int, Curve> curves;
    for (const ViscosityRow& r : chart.viscosity) {
        Curve& c = curves[r.stepsPerFrame];
        c.name = fmt::format("{} steps a frame", r.stepsPerFrame);
        if (r.viscosity > 0) c.points.emplace_back(r.iterations, r.viscosity);
    }
    for (const auto& [steps, curve] : curves) plot.curves.push_back(curve);
    return plot;
}

constexpr const char* kColumns =
    "case,what,setting,spacing,particles,error,wallPerSecond,sweepsPerSecond,stepsPerSecond,compression,fastest,front\n";

std::string csvOf(const Chart& chart, const std::string& machine) {
    std::string csv = fmt::format("# {}\n{}", machine, kColumns);
    const auto plain = [](std::string text) {
        std::replace(text.begin(), text.end(), ',', ';');
        return text;
    };
    for (const ChartRow& r : chart.rows)
        csv += fmt::format("{},{},{},{:.6g},{},{:.5g},{:.4g},{:.5g},{:.5g},{:.4g},{:.4g},{}\n", r.name, plain(r.what), plain(r.setting),
                           r.spacing, r.particles, r.error, r.wallPerSecond, r.sweepsPerSecond, r.stepsPerSecond, r.compression, r.fastest,
                           r.onFront ? 1 : 0);
    return csv;
}

}  // namespace

Status writeChart(const Chart& chart, const std::string& folder, const std::string& machine, const std::string& command) {
    const std::filesystem::path to(folder);
    std::string page = fmt::format(
        "# Speed against accuracy\n\nWritten by `{}` on: {}. All rows come from one run. Cost is the wall time of the steps per simulated "
        "second. A sweep is one pass over all neighbours, counted by the share of the particles that are awake; its count does not depend "
        "on the machine. Errors are the fractions that `rivulet "
        "validate` reports for the case. The table is `speed_accuracy.csv`; its copy in `assets/reference` is the one that the `budget` of "
        "a scene uses.\n\n| setting | "
        "meaning |\n| --- | --- |\n",
        command, machine);
    const auto wasRun = [&](const ChartSetting& s) {
        return std::any_of(chart.rows.begin(), chart.rows.end(), [&](const ChartRow& row) { return row.setting == s.name; });
    };
    for (const ChartSetting& s : chartSettings().rows)
        if (wasRun(s)) page += fmt::format("| {} | method {}: {} |\n", s.name, s.method, s.doc);
    page += '\n' + needs(chart);
    for (const std::string& name : caseNames(chart)) {
        const std::vector<ChartRow> rows = rowsOf(chart, name);
        const std::string picture = fmt::format("speed_accuracy_{}.svg", name);
        if (Status drawn = drawPlot(plotOf(rows), (to / picture).string()); !drawn) return drawn;
        const std::string_view set = chartAssignments(name);
        page += fmt::format("\n## {}\n\n{}{}.\n\n![error against cost]({})\n\n{}\n\n{}", name, physicsCases().find(name)->doc,
                            set.empty() ? "" : fmt::format("; here with {}", set), picture, bestOf(rows), tableOf(rows));
    }
    if (!chart.refused.empty()) {
        page += "\n## Combinations that could not be run\n\n";
        for (const std::string& line : chart.refused) page += "- " + line + '\n';
    }
    if (!chart.viscosity.empty()) {
        if (Status drawn = drawPlot(viscosityPlot(chart), (to / "pbf_viscosity.svg").string()); !drawn) return drawn;
        page += '\n' + viscosityPage(chart);
        std::string csv = fmt::format("# {}\niterations,stepsPerFrame,viscosity,periodError,wallPerSecond\n", machine);
        for (const ViscosityRow& r : chart.viscosity)
            csv += fmt::format("{},{},{:.5g},{:.5g},{:.4g}\n", r.iterations, r.stepsPerFrame, r.viscosity, r.periodError, r.wallPerSecond);
        if (Status written = writeFileAtomic((to / "pbf_viscosity.csv").string(), csv); !written) return written;
    }
    if (Status written = writeFileAtomic((to / "speed_accuracy.csv").string(), csvOf(chart, machine)); !written) return written;
    return writeFileAtomic((to / "speed_accuracy.md").string(), page);
}

}  // namespace rivulet
