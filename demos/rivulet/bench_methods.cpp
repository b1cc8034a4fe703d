// Compares the methods on a column of 0.5 x 0.5 x 1 m in a box of 1 m: wall time per simulated second, and the compression that remains.
#include <fmt/format.h>

#include <chrono>
#include <cmath>

#include "demos/rivulet/bench_cases.h"
#include "engine/compute/device_cpu.h"
#include "fluid/sim/world/cpu_kernels.h"
#include "fluid/sim/world/fluid_world.h"

namespace rivulet {

namespace {

constexpr double kSeconds = 0.2;  // simulated, from rest

struct Setting {
    const char* name;
    const char* column;
    float spacing;
    FluidParams (*params)();
};

FluidParams dfsph(int substeps, float reach, float tolerance, float correction) {
    FluidParams p;
    p.method = "dfsph";
    p.dfsph.minSubsteps = substeps;
    p.dfsph.reach = reach;
    p.dfsph.tolerance = tolerance;
    p.dfsph.correction = correction;
    return p;
}
FluidParams defaultsOf(const char* method) {
    FluidParams p;
    p.method = method;
    return p;
}

constexpr Setting kSettings[] = {
    {"dfsph, tolerance 1e-4, correction 0.3", "31k", 0.02F, [] { return dfsph(8, 0.3F, 1.0e-4F, 0.3F); }},
    {"dfsph, default settings", "31k", 0.02F, [] { return defaultsOf("dfsph"); }},
    {"dfsph, 6 substeps, reach 0.4, tolerance 1e-3", "31k", 0.02F, [] { return dfsph(6, 0.4F, 1.0e-3F, 0.2F); }},
    {"pbf, default settings", "31k", 0.02F, [] { return defaultsOf("pbf"); }},
    {"dfsph, default settings", "8k", 0.03125F, [] { return defaultsOf("dfsph"); }},
    {"dfsph, 4 substeps, reach 0.5, tolerance 8e-4", "8k", 0.03125F, [] { return dfsph(4, 0.5F, 8.0e-4F, 0.2F); }},
    {"pbf, default settings", "8k", 0.03125F, [] { return defaultsOf("pbf"); }},
    {"dfsph, 6 substeps, reach 0.4, tolerance 5e-4", "128k", 0.0125F, [] { return dfsph(6, 0.4F, 5.0e-4F, 0.2F); }},
    {"pbf, default settings", "128k", 0.0125F, [] { return defaultsOf("pbf"); }},
};

}  // namespace

// Measures wall seconds per simulated second. The row's name holds the mean compression over particles and frames, and the number of steps.
Status benchMethods(const BenchContext& context) {
    const std::vector<CpuKernelRow> rows = cpuKernels();
    auto device = makeCpuDevice(rows);
    for (const Setting& setting : kSettings) {
        FluidParams p = setting.params();
        p.spacing = setting.spacing;
        p.box.max = vec3(1.0F, 1.2F, 1.0F);
        p.blocks = {{vec3(0.0F), vec3(0.5F, 1.0F, 0.5F), vec3(0.0F)}};
        Status status = ok();
        double compression = 0, worst = 0;
        int substeps = 0;
        const Spread spread = repeat(context, [&] {
            Result<std::unique_ptr<FluidWorld>> world = FluidWorld::create(*device, p, {}, {});
            if (!world) {
                status = world.error();
                return 0.0;
            }
            double wall = 0;
            int frames = 0;
            compression = worst = 0;
            substeps = 0;
            while ((*world)->time() < kSeconds - 1.0e-9) {
                const auto begin = std::chrono::steady_clock::now();
                (*world)->step({.gravity = p.gravity}, 1.0 / 60);
                if (status = (*world)->lastStep(); !status) return 0.0;
                wall += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
                compression += (*world)->stats().avgCompression;
                worst = std::max(worst, (*world)->stats().maxCompression);
                substeps += (*world)->lastSubsteps();
                ++frames;
            }
            compression /= frames;
            return wall / (*world)->time();
        });
        if (!status) return status;
        BenchRow row{
            .name = fmt::format("column {}, {}: {:.3g} % compressed, {} steps", setting.column, setting.name, 100 * compression, substeps),
            .unit = "s/s",
            .value = spread,
            .passes = {}};
        const int runs = static_cast<int>(spread.count) + 1;
        for (const PassTime& t : device->takeTimes()) row.passes[t.name] = t.ms / runs / kSeconds;
        context.report(row);
    }
    return ok();
}

}  // namespace rivulet
