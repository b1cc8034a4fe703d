// The duck race: pools of more and more water, with one float dropped into each. What a pool costs is what is awake in it.
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <string_view>

#include "demos/rivulet/bench_cases.h"
#include "engine/compute/device_cpu.h"
#include "fluid/sim/solids/body_shapes.h"
#include "fluid/sim/world/cpu_kernels.h"
#include "fluid/sim/world/fluid_world.h"

namespace rivulet {

namespace {

constexpr float kSpacing = 0.02F, kDepth = 0.2F;                         // m
constexpr int kRest = 60, kRace = 600, kAwake = 6, kMostSettling = 600;  // frames of 1/60 s

// A free body that stays where it is until it is let go.
struct Held {
    FreeBodies free;
    bool released = false;
    BodyHost host() {
        return {.self = this,
                .advance =
                    [](void* self, std::span<const BodyLoad> loads, const vec3& gravity, double seconds, std::span<BodyState> states) {
                        Held& held = *static_cast<Held*>(self);
                        const BodyHost free = held.free.host();
                        if (held.released) free.advance(free.self, loads, gravity, seconds, states);
                    },
                .reset = [](void*, std::span<const BodyState>) {}};
    }
};

FluidParams poolOf(double thousand) {
    FluidParams p;
    p.method = "dfsph";
    p.spacing = kSpacing;
    p.sleep.on = true;
    const double layers = std::round(double{kDepth} / double{kSpacing});
    const float side = kSpacing * static_cast<float>(std::round(std::sqrt(thousand * 1000 / layers)));
    p.box.max = vec3(side, 2 * kDepth, side);
    p.blocks = {{.min = vec3(0.0F), .max = vec3(side, kDepth, side)}};
    return p;
}

}  // namespace

// The ball falls when all water sleeps: what is measured then is the splash. After the race the same pool is stepped awake, to compare.
Status benchSleep(const BenchContext& context) {
    const std::unique_ptr<CpuDevice> device = makeCpuDevice(cpuKernels());
    for (const double thousand : {1, 2, 4, 8, 16, 32, 64, 100, 300, 1000}) {
        const FluidParams params = poolOf(thousand);
        std::vector<Body> duck = {{.shape = sphereShape(0.05F, 300, kSpacing), .state = {}}};
        duck[0].state.pose.position = vec3(0.5F * params.box.max.x, kDepth + 0.15F, 0.5F * params.box.max.z);
        Held held{FreeBodies(duck)};
        Solids solids;
        solids.bodies = duck;
        solids.bodyHost = held.host();
        Result<std::unique_ptr<FluidWorld>> made = FluidWorld::create(*device, params, solids, context.log);
        if (!made) return made.error();
        FluidWorld& world = **made;
        const auto measure = [&, particles = world.stats().particles](std::string_view what, int frames) {
            const std::string name = fmt::format("duck race, {} particles, {}", particles, what);
            const double before = world.stats().stepped;
            int steps = 0;
            const auto start = std::chrono::steady_clock::now();
            for (int k = 0; k < frames; ++k) {
                world.step({}, 1.0 / 60);
                steps += world.lastSubsteps();
            }
            const double ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
            context.report({.name = name, .unit = "ms/step", .value = spreadOf({ms / steps}), .passes = {}});
            context.report({.name = name + ", awake",
                            .unit = "particles",
                            .value = spreadOf({(world.stats().stepped - before) / steps}),
                            .passes = {}});
        };
        for (int k = 0; k < kMostSettling && world.stats().asleep < world.stats().particles; ++k) world.step({}, 1.0 / 60);
        measure("at rest", kRest);
        held.released = true;
        measure("the race", kRace);
        FluidParams awake = params;
        awake.sleep.speed = 0;  // a bound that nothing meets
        if (const Status set = world.setParams(awake); !set) return set.error();
        measure("without sleep", kAwake);
    }
    return ok();
}

}  // namespace rivulet
