#include <fmt/format.h>

#include <filesystem>

#include "demos/rivulet/cli.h"
#include "demos/rivulet/interrupt.h"
#include "engine/app/capture.h"
#include "fluid/bridge/run_stats.h"
#include "fluid/sim/cpu_kernels.h"
#include "fluid/validate/chart.h"

namespace rivulet {

int chartVerb(const Arguments& arguments) {
    ArgumentReader reader("chart", "Charts speed against accuracy: every setting of every method, on the physics cases.");
    ChartRequest request;
    std::string folder = "docs";
    reader.footer("Writes speed_accuracy.md, its table and its pictures, and what pbf adds to viscosity.");
    reader.positional("CASE", "which cases; all that are charted when none is named", request.names);
    reader.flag("--quick", "fewer cases and sizes: ten minutes on two cores", request.quick);
    reader.option("--out", "DIR", "the folder that all is written to; docs if not given", folder);
    if (std::optional<int> code = reader.read(arguments)) return *code;
    for (const std::string& name : request.names)
        if (Status known = checkWord("charted case", name, chartCases()); !known) return report(known.error());
    if (Status made = makeFolder(folder); !made) return report(made.error());

    const std::vector<CpuKernelRow> rows = cpuKernels();
    const std::unique_ptr<Device> device = makeCpuDevice(rows);
    Graceful graceful;
    Progress progress("chart");
    request.device = device.get();
    request.goOn = [&](double share, const std::string& what) {
        progress.show(share, what);
        return !graceful.interrupted();
    };
    const Result<Chart> chart = runChart(request);
    if (!chart) return report(chart.error());
    if (chart->stopped) return kInterrupted;
    std::string command = "rivulet chart";
    for (const std::string& name : request.names) command += ' ' + name;
    if (request.quick) command += " --quick";
    if (Status written = writeChart(*chart, folder, machineName(), command); !written) return report(written.error());
    fmt::print("{}\n", (std::filesystem::path(folder) / "speed_accuracy.md").string());
    return kDone;
}

}  // namespace rivulet
