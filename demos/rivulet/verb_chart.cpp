#include <fmt/format.h>

#include <filesystem>
#include <optional>
#include <utility>

#include "demos/rivulet/chart_points.h"
#include "demos/rivulet/cli.h"
#include "demos/rivulet/interrupt.h"
#include "engine/app/capture.h"
#include "engine/core/file.h"
#include "engine/core/message_line.h"
#include "fluid/session/run_stats.h"
#include "fluid/sim/world/cpu_kernels.h"
#include "fluid/validate/chart.h"
#include "fluid/validate/envelope.h"
#include "fluid/validate/surface_chart.h"

namespace rivulet {

namespace {

constexpr const char* kStability = "stability";
constexpr const char* kSurface = "surface";

// Until a page is written, Ctrl-C exits at once: there is nothing to close.

// The stability limits of the methods: stability.md with a table and a chart.
int chartStability(Device& device, Progress& progress, const std::string& folder) {
    std::vector<EnvelopeFinding> all;
    for (const EnvelopeRow& row : envelope().rows) {
        progress.show(static_cast<double>(&row - envelope().rows.data()) / static_cast<double>(envelope().rows.size()),
                      fmt::format("stability, {}", row.name));
        const Result<std::vector<EnvelopeFinding>> found = row.run({.device = &device});
        if (!found) return report(found.error());
        all.insert(all.end(), found->begin(), found->end());
    }
    const Graceful graceful;
    if (Status written = writeEnvelope(folder, all, machineName()); !written) return report(written.error());
    fmt::print("{}\n", printable((std::filesystem::path(folder) / "stability.md").string()));
    return graceful.status();
}

// The error of the drawn surface and its cost: surface.md with a table and a chart.
int chartSurface(const SurfaceChartRequest& request, const std::string& folder, const std::string& command) {
    const Result<SurfaceChart> chart = runSurfaceChart(request);
    if (!chart) return report(chart.error());
    const Graceful graceful;
    if (Status written = writeSurfaceChart(*chart, folder, machineName(), command); !written) return report(written.error());
    fmt::print("{}\n", printable((std::filesystem::path(folder) / "surface.md").string()));
    return graceful.status();
}

// One point of the chart of speed against accuracy, to a file.
int chartOnePoint(const ChartRequest& request, size_t k, const std::string& file) {
    if (Status writable = checkWritable(file); !writable) return report(writable.error());
    const Result<ChartPoint> point = runChartPoint(request, k);
    if (!point) return report(point.error());
    const Status written = writeFileAtomic(file, chartPointText(request, k, *point));
    return written ? kDone : report(written.error());
}

// Speed against accuracy: speed_accuracy.md with a table and charts. `points`: the folder of a sweep that measured them; empty: they are
// measured.
int chartMethods(const ChartRequest& request, const std::string& folder, const std::string& points) {
    const Result<Chart> chart = points.empty() ? runChart(request) : chartOfSweep(request, points);
    if (!chart) return report(chart.error());
    const Graceful graceful;
    std::string command = "rivulet chart";
    for (const std::string& name : request.names) command += ' ' + name;
    if (request.quick) command += " --quick";
    if (!points.empty()) command += " --points DIR";
    if (Status written = writeChart(*chart, folder, machineName(), command); !written) return report(written.error());
    fmt::print("{}\n", printable((std::filesystem::path(folder) / "speed_accuracy.md").string()));
    return graceful.status();
}

// The options that divide the chart of speed against accuracy among processes.
struct ChartParts {
    std::string sweep, points, json;
    std::optional<int> point;
};

// `others`: stability or surface is named.
Status checkParts(const ChartParts& parts, const ChartRequest& request, bool others) {
    const std::pair<const char*, bool> options[] = {
        {"--sweep", !parts.sweep.empty()}, {"--points", !parts.points.empty()}, {"--point", parts.point.has_value()}};
    const char* first = nullptr;
    for (const auto& [name, used] : options) {
        if (!used) continue;
        if (first != nullptr) return badInput(fmt::format("{} cannot be used with {}; leave one of them out", name, first));
        first = name;
    }
    if (first != nullptr && others)
        return badInput(fmt::format("{} is of speed_accuracy.md alone; leave {} and {} out", first, kStability, kSurface));
    if (parts.point.has_value() == parts.json.empty())
        return badInput(parts.point ? "--point needs a file for its figures; add --json FILE.json"
                                    : "--json is the file of --point; add it");
    if (parts.point && static_cast<size_t>(*parts.point) >= chartPoints(request))
        return badInput(fmt::format("--point {}: the chart has {} points, the last is {}", *parts.point, chartPoints(request),
                                    chartPoints(request) - 1));
    return ok();
}

}  // namespace

int chartVerb(const Arguments& arguments) {
    ArgumentReader reader("chart", "Measures speed against accuracy: every setting of every method, on the cases of 'rivulet validate'.");
    ChartRequest request;
    ChartParts parts;
    std::string folder = "docs";
    reader.footer(
        "Writes, each with a table and charts:\n  speed_accuracy.md  speed and error of each setting, and the viscosity that pbf adds\n"
        "  stability.md       time steps and speeds at which each method becomes unstable if its limits are off\n"
        "  surface.md         error of the drawn surface by filter and quality, and its time in ms");
    reader.positional("CASE", "cases to measure, stability or surface; default: all", request.names);
    reader.flag("--quick", "fewer cases and sizes", request.quick);
    reader.option("--out", "DIR", "output folder; default: docs", folder);
    reader.option("--sweep", "FILE.json", "measure nothing; write a sweep with one task for each point of speed_accuracy.md", parts.sweep);
    reader.option("--points", "DIR", "make speed_accuracy.md of the points in the folder of that sweep", parts.points);
    reader.option("--point", "K", "measure one point of speed_accuracy.md, 0 for the first, and write it to --json", parts.point, 0,
                  1'000'000);
    reader.option("--json", "FILE.json", "file of --point", parts.json);
    if (std::optional<int> code = reader.read(arguments)) return *code;
    std::vector<std::string> known = chartCases();
    known.insert(known.end(), {kStability, kSurface});
    for (const std::string& name : request.names)
        if (Status right = checkWord("charted case", name, known); !right) return report(right.error());
    const bool all = request.names.empty(), stability = all || std::erase(request.names, kStability) > 0;
    const bool surface = all || std::erase(request.names, kSurface) > 0;
    const bool cases = all || !request.names.empty();
    const bool apart = parts.point || !parts.sweep.empty() || !parts.points.empty();  // speed_accuracy.md alone
    if (Status sense = checkParts(parts, request, !all && (stability || surface)); !sense) return report(sense.error());
    if (!parts.sweep.empty()) {
        if (Status written = writeFileAtomic(parts.sweep, sweepOfChart(request)); !written) return report(written.error());
        fmt::print("{}: {} points\n", printable(parts.sweep), chartPoints(request));
        return kDone;
    }
    if (!parts.point)
        if (Status made = makeFolder(folder); !made) return report(made.error());

    const std::vector<CpuKernelRow> rows = cpuKernels();
    const std::unique_ptr<Device> device = makeCpuDevice(rows);
    Progress progress("chart");
    request.device = device.get();
    request.goOn = [&](double share, const std::string& what) {
        progress.show(share, what);
        return true;
    };
    if (parts.point) return chartOnePoint(request, static_cast<size_t>(*parts.point), parts.json);
    if (stability && !apart)
        if (const int code = chartStability(*device, progress, folder); code != kDone) return code;
    if (cases)
        if (const int code = chartMethods(request, folder, parts.points); code != kDone) return code;
    if (surface && !apart) {
        const SurfaceChartRequest drawn{device.get(), {}, request.goOn, request.quick};
        return chartSurface(drawn, folder, request.quick ? "rivulet chart surface --quick" : "rivulet chart surface");
    }
    return kDone;
}

}  // namespace rivulet
