#include "fluid/validate/gpu_series.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string_view>

#include "engine/core/assert.h"
#include "engine/core/timeline.h"
#include "fluid/render/fluid_upload.h"
#include "fluid/session/cpu_fallback.h"
#include "fluid/session/session.h"

namespace rivulet {

namespace {

// Of a device that is software, passes are measured on the wall, and other programs lengthen them: scales them to `ms` together.
void scaleTo(double ms, std::map<std::string, double>& passes) {
    double sum = 0;
    for (const auto& [name, each] : passes) sum += each;
    if (sum > 0)
        for (auto& [name, each] : passes) each *= ms / sum;
}

// Draws a world seven times after the first, fewer past `until`; the fastest picture counts.
Status drawSeries(const ExaminedGpu& gpu, const FluidWorld& world, SceneRenderer& renderer, const SceneFile& scene, double until,
                  SeriesRow& row) {
    const Bounds bounds{world.params().box.min, world.params().box.max};
    const FrameView view = frameViewOf(cameraOf(scene.camera, bounds), scene.light, kSeriesWidth, kSeriesHeight, 0);
    FluidUpload upload;
    row.drawMs = 1.0e9;
    for (int k = 0; k < 2 || (k < 8 && hostSeconds() < until); ++k) {
        const double start = deviceSeconds(*gpu.device);
        const Result<FluidView> fluid = upload.view(world, scene.look);
        if (!fluid) return fluid.error();
        if (Status drawn = renderer.draw(view, *fluid, {}, scene); !drawn) return drawn;
        renderer.finish();
        if (k == 0) continue;  // compiles, and makes what is kept between pictures
        row.drawMs = std::min(row.drawMs, 1000 * (deviceSeconds(*gpu.device) - start));
        for (const PassTime& pass : renderer.times()) {
            if (pass.calls == 0) continue;
            const auto [at, fresh] = row.drawPasses.try_emplace(pass.name, pass.ms);
            at->second = std::min(at->second, pass.ms);
        }
    }
    if (gpu.device->info().software) scaleTo(row.drawMs, row.drawPasses);
    if (gpu.from.empty()) return ok();
    const FrameCost cost = predictPicture(gpu.model, row.particles);
    row.predictedDrawMs = cost.ms();
    for (const PassCost& pass : cost.passes) row.predictedDrawPasses[pass.name] = pass.ms;
    return ok();
}

}  // namespace

int threadsInStep(std::string_view backend) { return backend == "gl" ? 8 : 1; }

ExaminedGpu namedGpu(Device& device, const std::string& name) {
    ExaminedGpu e{.device = &device, .name = name};
    if (device.info().software) return e;
    if (const NearestGpu named = nearestGpu(name, 0); named.byName) {
        e.model = named.gpu;
        e.from = fmt::format("{}, by its name", named.gpu.name);
    }
    return e;
}

Result<ExaminedGpu> examineGpu(Device& device, const std::string& name, double until) {
    const Result<std::optional<DeviceRates>> rates = measureRates(device, until);
    if (!rates) return rates.error();
    if (!*rates) return namedGpu(device, name);
    ExaminedGpu e{.device = &device, .name = name, .measured = true, .rates = **rates};
    if (device.info().software) {
        e.model = measuredGpu(name, e.rates, threadsInStep(backendName(device.backend())));
        e.from = "its own measured rates";
    } else {
        const NearestGpu nearest = nearestGpu(name, e.rates.bandwidth);
        e.model = nearest.gpu;
        e.from = fmt::format("{}, {}", nearest.gpu.name, nearest.byName ? "by its name" : "the nearest in bandwidth");
    }
    return e;
}

int seriesParticles(int side) { return 2 * side * side * side; }

FluidParams seriesWater(const SceneFile& damBreak, const char* method, int side) {
    FluidParams p = damBreak.fluid;
    p.method = method;
    p.spacing = 0.25F / static_cast<float>(side);
    p.ellipsoids = true;
    return p;
}

Result<SeriesRow> measureSeries(const ExaminedGpu& gpu, const SceneFile& damBreak, const char* method, int side, double seconds,
                                SceneRenderer* renderer, double until) {
    Device& device = *gpu.device;
    const FluidParams params = seriesWater(damBreak, method, side);
    Result<std::unique_ptr<FluidWorld>> made = FluidWorld::create(device, params, {}, {});
    if (!made) return made.error();
    FluidWorld& world = **made;
    SeriesRow row{.device = backendName(device.backend()), .method = method, .particles = seriesParticles(side)};
    const FrameWork work = measuredWork(method, row.particles);
    const double stepSeconds = 1.0 / kFramesPerSecond / work.substeps;
    const auto advance = [&] {
        world.step({.gravity = params.gravity}, stepSeconds);
        device.finish();
        device.poll();
        return world.lastSubsteps();
    };
    // The first compiles kernels; a GPU at first queues iterations generously, and reports them late.
    for (; row.warmSteps < 8 && (row.warmSteps == 0 || hostSeconds() < until); ++row.warmSteps) advance();
    device.takeTimes();
    int steps = 0, calls = 0;
    double iterations = 0;
    const double start = deviceSeconds(device), wall = hostSeconds();
    while (calls == 0 || hostSeconds() < std::min(wall + seconds, until)) {
        const int done = advance();
        for (const PassTime& t : device.takeTimes()) {
            const auto [at, fresh] = row.passes.try_emplace(t.name, t.ms / done);
            at->second = std::min(at->second, t.ms / done);
        }
        steps += done;
        iterations += world.stats().iterations * done;
        ++calls;
    }
    row.stepMs = 1000 * (deviceSeconds(device) - start) / steps;
    if (device.info().software) scaleTo(row.stepMs, row.passes);
    row.iterations = iterations / steps;
    if (Status sound = stillWorks(device); !sound) return sound.error();
    row.substeps = static_cast<double>(steps) / calls;
    if (!gpu.from.empty()) {
        const FrameCost step = predictSteps(gpu.model, method, row.particles, {row.substeps, row.iterations});
        row.predictedStepMs = step.ms() / row.substeps;
        for (const PassCost& pass : step.passes) row.predictedPasses[pass.name] = pass.ms / row.substeps;
        // The frame: as many substeps, each with as many iterations, as a run on the cpu has. The share of iterations is the model's.
        row.predictedFrameMs = predictSteps(gpu.model, method, row.particles, work).ms();
        row.frameMs = row.predictedStepMs > 0 ? row.stepMs / row.predictedStepMs * row.predictedFrameMs : 0;
    }
    if (renderer == nullptr || hostSeconds() >= until) return row;
    ASSERT(device.backend() == Backend::gl, "the clock and the model are of the device that draws");
    if (Status drawn = drawSeries(gpu, world, *renderer, damBreak, until, row); !drawn) {
        row.drawMs = 0;
        row.drawPasses.clear();
        row.notDrawn = drawn.error();
    }
    return row;
}

}  // namespace rivulet
