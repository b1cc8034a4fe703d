// The duck race: pools of more and more water, with one float dropped into each. What a pool costs is what is awake in it.
#include <fmt/format.h>

#include <chrono>
#include <cmath>

#include "demos/rivulet/bench_cases.h"
#include "engine/compute/device_cpu.h"
#include "fluid/sim/solids/body_shapes.h"
#include "fluid/sim/world/cpu_kernels.h"
#include "fluid/sim/world/fluid_world.h"

namespace rivulet {

namespace {

constexpr float kSpacing = 0.02F, kDepth = 0.4F;  // m
constexpr double kSettles = 2, kRace = 10;        // s

// A pool of about `thousand` thousand particles, with a ball of the size of a duck above it.
struct Pool {
    FluidParams params;
    Solids solids;
};
Pool poolOf(double thousand, bool sleeps) {
    Pool pool;
    FluidParams& p = pool.params;
    p.method = "dfsph";
    p.spacing = kSpacing;
    p.sleep.on = sleeps;
    const double layers = std::round(double{kDepth} / double{kSpacing});
    const float side = kSpacing * static_cast<float>(std::round(std::sqrt(thousand * 1000 / layers)));
    p.box.min = vec3(0.0F);
    p.box.max = vec3(side, 2 * kDepth, side);
    p.blocks = {{.min = vec3(0.0F), .max = vec3(side, kDepth, side)}};
    p.blocks[0].jitter = 0;
    Body duck{.shape = sphereShape(0.05F, 300, kSpacing), .state = {}};
    duck.state.pose.position = vec3(0.5F * side, kDepth + 0.15F, 0.5F * side);
    pool.solids.bodies = {duck};
    return pool;
}

}  // namespace

Status benchSleep(const BenchContext& context) {
    const std::unique_ptr<CpuDevice> device = makeCpuDevice(cpuKernels());
    for (const double thousand : {1, 2, 4, 8, 16, 32, 64, 128, 512, 1000}) {
        const Pool pool = poolOf(thousand, true);
        Result<std::unique_ptr<FluidWorld>> made = FluidWorld::create(*device, pool.params, pool.solids, {});
        if (!made) return made.error();
        FluidWorld& world = **made;
        double awake = 0;
        int steps = 0;
        const auto start = std::chrono::steady_clock::now();
        for (int k = 0; k < static_cast<int>(60 * kRace) && !context.interrupted(); ++k) {
            world.step({}, 1.0 / 60);
            awake += (world.stats().particles - world.stats().asleep) * static_cast<double>(world.lastSubsteps());
            steps += world.lastSubsteps();
            if (k % 30 == 0)
                fmt::print("{} {} awake {} y {} v {}\n", thousand, k, world.stats().particles - world.stats().asleep,
                           world.bodies()[0].pose.position.y, world.stats().maxSpeed);
        }
        if (context.interrupted()) return ok();
        const double ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
        context.report({.name = fmt::format("duck race, {} particles", world.stats().particles),
                        .unit = "ms/step",
                        .value = spreadOf({ms / steps}),
                        .passes = {}});
        context.report({.name = fmt::format("duck race, {} particles: awake", world.stats().particles),
                        .unit = "particles",
                        .value = spreadOf({awake / steps}),
                        .passes = {}});
    }
    return ok();
}

}  // namespace rivulet
