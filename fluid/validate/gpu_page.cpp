#include "fluid/validate/gpu_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/core/file.h"
#include "fluid/session/reference_data.h"
#include "fluid/session/run_stats.h"

namespace rivulet {

namespace {

constexpr std::array<const char*, 3> kMethods = {"wcsph", "pbf", "dfsph"};
constexpr std::array<double, 2> kParticles = {1.0e5, 1.0e6};
constexpr std::array<const char*, 2> kShown = {"RTX 3060", "RX 6800"};

double errorOf(double predicted, double measured) { return measured > 0 ? predicted / measured - 1 : 0; }

std::string percent(double share) { return fmt::format("{:+.0f} %", 100 * share); }

const GpuSpec* find(const std::vector<GpuSpec>& all, std::string_view name) {
    const auto found = std::find_if(all.begin(), all.end(), [&](const GpuSpec& g) { return g.name == name; });
    return found == all.end() ? nullptr : &*found;
}

std::string predictions(const std::vector<GpuSpec>& gpus) {
    std::string page =
        "## Predicted frames\n\nms for a frame of 1/60 s of dam_break at default settings, and for a picture of it, 1920x1080, fine.\n\n"
        "| GPU | wcsph, 100,000 particles | pbf | dfsph | picture | wcsph, 1,000,000 | pbf | dfsph | picture |\n"
        "| --- | --- | --- | --- | --- | --- | --- | --- | --- |\n";
    for (const GpuSpec& gpu : gpus) {
        page += fmt::format("| {} |", gpu.name);
        for (const double particles : kParticles) {
            for (const char* method : kMethods)
                page += fmt::format(" {:.3g} |", predictSteps(gpu, method, particles, measuredWork(method, particles)).ms());
            page += fmt::format(" {:.3g} |", predictPicture(gpu, particles).ms());
        }
        page += "\n";
    }
    for (const char* name : kShown)
        if (const GpuSpec* gpu = find(gpus, name)) {
            const double steps = predictSteps(*gpu, "pbf", 1.0e6, measuredWork("pbf", 1.0e6)).ms(),
                         picture = predictPicture(*gpu, 1.0e6).ms();
            page += fmt::format("\n{}: a million particles with pbf, simulated and drawn, take {:.3g} ms a frame ({:.3g} + {:.3g}).\n",
                                name, steps + picture, steps, picture);
        }
    return page + "\n";
}

void addPasses(std::string& page, const FrameCost& cost, double particles, size_t most) {
    for (size_t k = 0; k < std::min(cost.passes.size(), most); ++k) {
        const PassCost& p = cost.passes[k];
        page += fmt::format("| {} | {:.3g} | {:.0f} % | {} | {:.0f} | {:.0f} | {:.0f} |\n", p.name, p.ms, 100 * p.ms / cost.ms(), p.bound,
                            p.dispatches, p.operations / particles / std::max(p.dispatches, 1.0),
                            p.bytes / particles / std::max(p.dispatches, 1.0));
    }
}

std::string dominating(const std::vector<GpuSpec>& gpus) {
    const GpuSpec* gpu = find(gpus, kShown[0]);
    if (gpu == nullptr) return "";
    std::string page = fmt::format(
        "## Passes that dominate\n\n{}, 1,000,000 particles. Operations and bytes of memory are of one dispatch, a particle.\n", gpu->name);
    constexpr const char* kHead =
        "| pass | ms a frame | share | limited by | dispatches | operations | bytes |\n| --- | --- | --- | --- | --- | --- | --- |\n";
    for (const char* method : kMethods) {
        page += fmt::format("\n`{}`:\n\n{}", method, kHead);
        addPasses(page, predictSteps(*gpu, method, 1.0e6, measuredWork(method, 1.0e6)), 1.0e6, 6);
    }
    page += fmt::format("\nThe picture:\n\n{}", kHead);
    addPasses(page, predictPicture(*gpu, 1.0e6), 1.0e6, 8);
    return page + "\n";
}

std::string errorsHere(const GpuModelRun& run) {
    std::string page =
        "## Error on the devices here\n\nTwo devices that are software, with rates measured by tiny kernels (`shaders/bench`) and not "
        "fitted to the result. Times are processor time over the number of threads, ms a substep; error: predicted over measured, less "
        "1.\n\n"
        "| device | bandwidth, GB/s | arithmetic, 1e9/s | integers | roots | loads | rounds of a loop | dispatch, us | fragments | "
        "filtered "
        "reads | texels |\n| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n";
    for (const ExaminedGpu& g : run.gpus) {
        page += fmt::format("| {} ({}) |", g.name, backendName(g.device->backend()));
        const DeviceRates& r = g.rates;
        for (const double each : {r.bandwidth / 1e9, r.arithmetic / 1e9, r.integer / 1e9, r.special / 1e9, r.loads / 1e9, r.rounds / 1e9,
                                  1000 * r.dispatchMs, r.fragments / 1e9, r.filtered / 1e9, r.fetches / 1e9})
            page += each > 0 ? fmt::format(" {:.3g} |", each) : std::string(" |");
        page += "\n";
    }
    page += "\n| device | method | particles | measured | predicted | error |\n| --- | --- | --- | --- | --- | --- |\n";
    for (const SeriesRow& r : run.rows) {
        page += fmt::format("| {} | {} | {} | {:.3g} | {:.3g} | {} |\n", r.device, r.method, r.particles, r.stepMs, r.predictedStepMs,
                            percent(errorOf(r.predictedStepMs, r.stepMs)));
        if (r.drawMs > 0)
            page += fmt::format("| {} | picture | {} | {:.3g} | {:.3g} | {} |\n", r.device, r.particles, r.drawMs, r.predictedDrawMs,
                                percent(errorOf(r.predictedDrawMs, r.drawMs)));
    }
    page +=
        "\nBy pass: shares of the time on the wall, scaled to the substep's or the picture's, and the error. Passes below 2 % are left "
        "out.\n\n"
        "| device | method | pass | measured | predicted | error |\n| --- | --- | --- | --- | --- | --- |\n";
    for (const SeriesRow& r : run.rows) {
        const bool largest = std::none_of(run.rows.begin(), run.rows.end(), [&](const SeriesRow& o) {
            return o.device == r.device && o.method == r.method && o.particles > r.particles;
        });
        if (!largest) continue;
        const auto add = [&](const char* method, const std::map<std::string, double>& measured,
                             const std::map<std::string, double>& predicted) {
            double whole = 0;
            for (const auto& [name, ms] : measured) whole += ms;
            for (const auto& [name, ms] : measured) {
                const auto found = predicted.find(name);
                if (ms < 0.02 * whole) continue;
                page += fmt::format("| {} | {} | {} | {:.3g} |", r.device, method, name, ms);
                page += found == predicted.end() ? std::string(" | |\n")
                                                 : fmt::format(" {:.3g} | {} |\n", found->second, percent(errorOf(found->second, ms)));
            }
        };
        add(r.method.c_str(), r.passes, r.predictedPasses);
        if (r.drawMs > 0) add("picture", r.drawPasses, r.predictedDrawPasses);
    }
    return page + "\n";
}

std::string errorsThere(const std::vector<GpuSpec>& gpus) {
    const ReferenceRows table = rowsOf(gpuTables(), "measured");
    std::string page =
        "## Against a GPU\n\nFrames of [performance.md](performance.md), which the model was not fitted to, with the kernels of that "
        "version (`assets/gpus/kernels_before.csv`, counted with 1,024 particles).\n\n"
        "| GPU | backend | method | particles | measured, ms a frame | predicted | error |\n| --- | --- | --- | --- | --- | --- | --- |\n";
    for (const std::vector<std::string_view>& row : table.rows) {
        const auto cell = [&](const char* column) { return row[table.column(column)]; };
        const GpuSpec* gpu = find(gpus, cell("gpu"));
        if (gpu == nullptr) continue;
        const double particles = numberIn(cell("particles")), measured = numberIn(cell("frame_ms"));
        const double predicted =
            predictSteps(*gpu, cell("method"), particles, measuredWork(cell("method"), particles), "kernels_before").ms();
        page += fmt::format("| {} | {} | {} | {:.0f} | {:.3g} | {:.3g} | {} |\n", gpu->name, cell("backend"), cell("method"), particles,
                            measured, predicted, percent(errorOf(predicted, measured)));
    }
    return page + "\n";
}

std::string beforeAndAfter() {
    const ReferenceRows before = rowsOf(gpuTables(), "kernels_before"), after = rowsOf(gpuTables(), "kernels");
    const auto sum = [](const ReferenceRows& t, const std::vector<std::string_view>& row) {
        double operations = 0;
        for (const char* kind :
             {"arithmetic", "special", "integers", "branches", "uniforms", "loads", "stores", "atomics", "shared", "barriers"})
            operations += numberIn(row[t.column(kind)]);
        return operations;
    };
    std::string page =
        "## Pair loops, before and after\n\nThe sweeps over neighbours dominated every method. A GPU now first finds the neighbours within "
        "the support radius, a sixth of those in the cells, and computes the terms of these alone. The first sweep of a step keeps a bit "
        "for each of them, 72 bytes a particle, and later sweeps do not search again (`FOR_PAIRS` in `shaders/fluid/grid/neighbors.h`). "
        "Counted with 1,024 particles, a thread, the mean of all calls in a step; in step: of 32 threads that go through the code "
        "together, over 32. Times on the devices here are in [performance.md](performance.md#on-a-gpu).\n\n"
        "| kernel | operations, before | after | in step, before | after | longest thread, before | after |\n"
        "| --- | --- | --- | --- | --- | --- | --- |\n";
    for (const std::vector<std::string_view>& b : before.rows)
        for (const std::vector<std::string_view>& a : after.rows) {
            const auto same = [&](const char* column) { return b[before.column(column)] == a[after.column(column)]; };
            if (!same("method") || !same("kernel") || !same("particles") || numberIn(a[after.column("particles")]) != 1024) continue;
            if (sum(after, a) > 0.9 * sum(before, b)) continue;
            page += fmt::format("| {} | {:.0f} | {:.0f} |", b[before.column("kernel")], sum(before, b), sum(after, a));
            for (const char* column : {"step32", "longest"})
                page += fmt::format(" {:.0f} | {:.0f} |", numberIn(b[before.column(column)]), numberIn(a[after.column(column)]));
            page += "\n";
        }
    return page + "\n";
}

constexpr const char* kModel = R"(## The model

Counted, on small worlds, by [tests/gpu_cost](../tests/gpu_cost/README.md): for each kernel operations by kind, loads and stores, the sectors of 32 bytes
that a dispatch touches, the accesses of 32 threads together, the operations of groups of 8, 32 and 64 threads that go through the code in step, and
those of the longest thread. For each drawing pass: invocations of its shaders, their reads of textures, bytes, and operations. Counts at three
sizes are extended along the inverse edge of the water, as the share of particles at walls is.

A dispatch takes the time of a launch, and the longest of these:

| limit | time |
| --- | --- |
| operations | threads x operations in step, over lanes and clock; a root or division counts 8, a branch 2 |
| cache | sectors of all accesses, over the first cache's bytes a clock |
| memory | sectors touched once in a dispatch, over the bandwidth |
| waits | operations and loads of all threads one after the other, with their latencies, over the threads that the GPU holds at once |
| longest thread | the same of the longest thread alone |

Figures of GPUs are published ones (`assets/gpus/gpus.csv`, with sources). Of a device that is software, each kind of operation has its measured rate; a
drawing pass takes the sum of its operations, written fragments, and filtered and fetched reads.

## Limits of the model

- Boost clock, and nothing else on the GPU. A GPU that lowers its clock is slower in proportion.
- Counts are of OpenCL C compiled by clang for Oclgrind; a driver's compiler may contract, unroll or spill otherwise.
- No second cache: what misses the first is either in it or read once a dispatch.
- Threads in step wait for each other at the end of each branch and loop; GPUs may let them run apart. How much more they do together than alone is
  that of the largest world counted, with more walls about it than a million particles have: large worlds are faster than predicted by that.
- Substeps and iterations are the cpu's, of the first frames of a dam break. Queued iterations that a GPU skips cost a launch, and are not counted.
- Operations of fragment shaders are those of the compiled text, times its counted reads over the reads in that text: loops of reads alone.
- Occupancy is full, unless `kernels.csv` (column `waves`) says less.
- Latencies of AMD and Intel are about right, not published by them.
)";

}  // namespace

Status writeGpuPage(const GpuModelRun& run, const std::string& folder, const std::string& command) {
    const std::vector<GpuSpec> gpus = publishedGpus();
    std::string csv = "gpu,method,particles,substeps,iterations,simulate_ms,draw_ms\n";
    for (const GpuSpec& gpu : gpus)
        for (const double particles : kParticles)
            for (const char* method : kMethods) {
                const FrameWork work = measuredWork(method, particles);
                csv += fmt::format("{},{},{:.0f},{:.4g},{:.4g},{:.4g},{:.4g}\n", gpu.name, method, particles, work.substeps,
                                   work.iterations, predictSteps(gpu, method, particles, work).ms(), predictPicture(gpu, particles).ms());
            }
    if (Status written = writeFileAtomic(folder + "/gpus.csv", csv); !written) return written;
    const std::string page = fmt::format(
                                 "# GPUs: a cost model\n\nWhat a frame costs on GPUs, by what its kernels and passes do and what the GPU "
                                 "can do. Written by `{}` on: {}; "
                                 "[gpus.csv](gpus.csv) has the predictions. `rivulet bench gpu` measures your GPU beside them.\n\n",
                                 command, machineName()) +
                             predictions(gpus) + dominating(gpus) + beforeAndAfter() + errorsHere(run) + errorsThere(gpus) + kModel;
    return writeFileAtomic(folder + "/gpus.md", page);
}

}  // namespace rivulet
