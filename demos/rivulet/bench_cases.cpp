// Benchmarks of the simulation: a column of 0.5 x 0.5 x 1 m in a box of 1 m, and the thesis's series of falling columns of 16,384 i
// particles.
#include "demos/rivulet/bench_cases.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>

#include "engine/app/context_egl.h"
#include "engine/compute/device_cpu.h"
#include "fluid/render/backend.h"
#include "fluid/session/cpu_fallback.h"
#include "fluid/sim/world/cpu_kernels.h"
#include "fluid/sim/world/fluid_world.h"

namespace rivulet {

namespace {

struct Column {
    const char* name;
    float spacing;
};
// 8,192, 31,250 and 128,000 particles.
constexpr Column kColumns[] = {{"8k", 0.03125F}, {"31k", 0.02F}, {"128k", 0.0125F}};

FluidParams columnScene(float spacing) {
    FluidParams p{.method = "wcsph"};
    p.spacing = spacing;
    p.blocks = {{vec3(0.0F), vec3(0.5F, 1.0F, 0.5F), vec3(0.0F)}};
    return p;
}

// Thesis 2.4: a column in free fall in a box of 1 m; its height is i / 8 m.
FluidParams seriesScene(int i) {
    FluidParams p{.method = "wcsph"};
    p.spacing = 1.0F / 128.0F;
    p.blocks = {{vec3(0.375F, 0.0F, 0.375F), vec3(0.625F, 0.125F * static_cast<float>(i), 0.625F), vec3(0.0F)}};
    return p;
}

// One device for each backend of this machine, and the GL context that the device gl needs.
struct Devices {
    Result<ContextEgl> context = failed("not opened yet");
    std::vector<std::unique_ptr<Device>> list;
};

Devices allDevices(const Log& log) {
    Devices all;
    all.context = ContextEgl::create();
    const GlFacts gl = all.context ? currentGlFacts() : GlFacts{};
    for (const char* name : {"cpu", "gl", "cl"}) {
        std::unique_ptr<Device> device = makeDevice(name, gl, log);
        if (std::string(backendName(device->backend())) == name) all.list.push_back(std::move(device));
    }
    return all;
}

struct Measured {
    double msPerStep = 0;
    std::map<std::string, double> passes;  // ms per step
};

// Steps one world from t = 0 to `seconds`, in `frames` calls.
Result<Measured> measure(Device& device, const FluidParams& params, double seconds, int frames) {
    Result<std::unique_ptr<FluidWorld>> world = FluidWorld::create(device, params, {}, {});
    if (!world) return world.error();
    device.finish();
    device.takeTimes();
    Measured m;
    int steps = 0;
    const auto start = std::chrono::steady_clock::now();
    for (int k = 0; k < frames; ++k) {
        (*world)->step({params.gravity}, seconds / frames);
        steps += (*world)->lastSubsteps();
    }
    device.finish();
    m.msPerStep = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count() / steps;
    for (const PassTime& t : device.takeTimes()) m.passes[t.name] = t.ms / steps;
    if (Status sound = stillWorks(device); !sound) return sound.error();
    return m;
}

// Measures several runs, each with a new world, and reports them; the pass times are those of the last run.
Status report(const BenchContext& context, const std::string& name, Device& device, const FluidParams& params, double seconds, int frames) {
    Measured last;
    Status status = ok();
    BenchRow row{.name = name,
                 .unit = "ms/step",
                 .value = repeat(context,
                                 [&] {
                                     Result<Measured> m = measure(device, params, seconds, frames);
                                     if (!m) {
                                         status = m.error();
                                         return 0.0;
                                     }
                                     last = *m;
                                     return m->msPerStep;
                                 }),
                 .passes = {}};
    row.passes = last.passes;
    if (status) context.report(row);
    return status;
}

Status benchStep(const BenchContext& context) {
    const std::vector<CpuKernelRow> rows = cpuKernels();
    auto device = makeCpuDevice(rows);
    for (const Column& c : kColumns)
        if (Status s = report(context, fmt::format("wcsph step, column {}, cpu", c.name), *device, columnScene(c.spacing), 0.1, 6); !s)
            return s;
    return ok();
}

Status benchMemory(const BenchContext& context) {
    Devices devices = allDevices(context.log);
    for (const std::unique_ptr<Device>& device : devices.list) {
        const FluidParams p = columnScene(kColumns[2].spacing);
        const size_t before = device->bytesAllocated();
        Result<std::unique_ptr<FluidWorld>> world = FluidWorld::create(*device, p, {}, {});
        if (!world) return world.error();
        (*world)->step({.gravity = p.gravity}, 1.0e-3);
        device->finish();
        if (Status sound = stillWorks(*device); !sound) return sound;
        const double bytes = static_cast<double>(device->bytesAllocated() - before) / (*world)->particles().count;
        context.report({.name = fmt::format("memory, column 128k, {}", backendName(device->backend())),
                        .unit = "B/particle",
                        .value = spreadOf({bytes}),
                        .passes = {}});
    }
    return ok();
}

// The density pass alone on each device: compares software GL and CL with the native CPU path.
Status benchDensity(const BenchContext& context) {
    Devices devices = allDevices(context.log);
    const FluidParams p = columnScene(kColumns[1].spacing);
    for (const std::unique_ptr<Device>& device : devices.list) {
        Status status = ok();
        double list = 0;
        const Spread spread = repeat(context, [&] {
            Result<Measured> m = measure(*device, p, 4.0e-3, 1);
            if (!m) {
                status = m.error();
                return 0.0;
            }
            list = m->passes["fluid/grid/cpu_neighbor_list"];
            return m->passes["fluid/methods/wcsph_density"];
        });
        if (!status) return status;
        BenchRow row{.name = fmt::format("density pass, column 31k, {}", backendName(device->backend())),
                     .unit = "ms",
                     .value = spread,
                     .passes = {}};
        if (list > 0) row.passes["neighbour lists, not counted above"] = list;
        context.report(row);
    }
    return ok();
}

Status benchSeries(const BenchContext& context) {
    Devices devices = allDevices(context.log);
    for (const std::unique_ptr<Device>& device : devices.list)
        for (int i = 1; i <= 8; ++i) {
            const FluidParams p = seriesScene(i);
            const double seconds = device->backend() == Backend::cpu || !device->info().software ? 5.0e-3 : 1.0e-3;
            const std::string name = fmt::format("falling column, {} particles, {}", 16384 * i, backendName(device->backend()));
            if (Status s = report(context, name, *device, p, seconds, 1); !s) return s;
        }
    return ok();
}

}  // namespace

Table<BenchCase> benchCases() {
    static constexpr BenchCase rows[] = {
        {"step", "one WCSPH step on the cpu: column of 8k, 31k and 128k particles, t = 0 to 0.1 s", benchStep, "--runs"},
        {"methods", "wall time per simulated second and mean compression of each method: column of 8k, 31k and 128k, t = 0 to 0.2 s",
         benchMethods, "--runs"},
        {"density", "the density pass on every device: column of 31k particles", benchDensity, "--runs"},
        {"memory", "bytes per particle on every device: column of 128k particles", benchMemory, ""},
        {"series", "the thesis's falling column on every device: 16,384 i particles, i = 1 to 8", benchSeries, "--runs"},
        {"gpu",
         "a minute on this GPU: whether it computes the same water as the cpu (exit status 1 if not), then 100,000 to 1,000,000 particles, "
         "drawn, beside the prediction of docs/gpus.md",
         benchGpu, "--quick --seconds"},
        {"gpu_model", "the cost model of GPUs against this machine's devices; with --out, the page gpus.md", benchGpuModel,
         "--quick --out"},
        {"voxels", "voxelisation of a mesh of 70,000 triangles in every mode, and its signed distance field", benchVoxels, "--runs"},
        {"collide", "share of a step spent on collision with a mesh: 16,384 particles", benchCollide, "--runs"},
        {"chapter2", "the thesis's chapter 2: times of the parts of a frame, one device against CPU and GPU together; with --out, a page",
         benchChapter2, "--runs --out"},
        {"chapter4", "the thesis's chapter 4: frames per second with its linked lists and with the sorted grid, on gl; with --out, a page",
         benchChapter4, "--runs --out"},
        {"flow", "one frame of 512 and 4,096 drops on a deforming head, drawn into maps of 1024 x 1024 texels, on the cpu", benchFlow,
         "--runs"},
        {"host", "cost of water in another engine's frame: saving its OpenGL state, uploading particles, drawing into its framebuffer",
         benchHost, "--runs"},
        {"draw", "one picture of the dam break at 1920x1080, fine and fast: time of each pass, and bytes that passes read and write",
         benchDraw, "--runs"},
        {"sleep", "the duck race: pools of 1,000 to 1,000,000 particles, one float dropped into each: cost and awake particles", benchSleep,
         ""},
        {"ui", "CPU time of a frame of an empty scene and of its panels, one tab after the other, in a window of 1280 x 720", benchUi,
         "--runs"},
    };
    return {rows};
}

}  // namespace rivulet
