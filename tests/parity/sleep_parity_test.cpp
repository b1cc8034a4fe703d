// fluid.sleep on cl and gl: a pool falls asleep where it does on the cpu, wakes, and sleeps again.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "fluid/sim/solids/body_shapes.h"
#include "tests/parity/devices.h"

namespace rivulet::sleep_parity_test {
namespace {

constexpr float kSpacing = 0.04F;

struct Case {
    const char *device, *method;
    bool body;
    float jitter;  // spacings; a lattice without any breaks up by rounding alone, and settles after 88 to 205 frames of `pbf`
};

std::unique_ptr<FluidWorld> pool(Device& device, const Case& of) {
    FluidParams p;
    p.method = of.method;
    p.spacing = kSpacing;
    p.sleep.on = true;
    p.sleep.speed = 0.08F;  // soon
    p.box.max = vec3(0.4F);
    p.blocks = {{.min = vec3(0.0F), .max = vec3(0.4F, 0.2F, 0.4F)}};
    p.blocks[0].jitter = of.jitter;
    Solids solids;
    if (of.body) {
        solids.bodies.resize(1);
        solids.bodies[0].shape = sphereShape(0.08F, 0, kSpacing);  // stands on the floor
        solids.bodies[0].state.pose.position = vec3(0.2F, 0.08F, 0.2F);
    }
    auto world = FluidWorld::create(device, p, solids, {});
    EXPECT_TRUE(world) << (world ? "" : world.error().message);
    return world ? std::move(*world) : nullptr;
}

// Frames until all sleep; the figures of a GPU are some frames late.
int settle(FluidWorld& world) {
    int k = 0;
    for (; k < 300 && world.stats().asleep < world.stats().particles; ++k) {
        world.step({}, 1.0 / 60);
        world.device().finish();
        world.device().poll();
    }
    return k;
}

std::vector<vec4> byId(FluidWorld& world) {
    const ParticleView view = world.particles();
    const auto x = world.device().readAll<vec4>(*view.position, view.slots);
    const auto id = world.device().readAll<uint32_t>(*view.id, view.slots);
    std::vector<vec4> all(view.slots);
    for (size_t k = 0; k < x.size(); ++k) all[id[k]] = x[k];
    all.resize(view.count);
    return all;
}

class SleepParity : public testing::TestWithParam<Case> {};

TEST_P(SleepParity, FallsAsleepWhereTheCpuDoesAndWakes) {
    Result<TestGpu> gpu = makeTestGpu(GetParam().device);
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    auto cpu = makeTestCpu();
    auto expected = pool(*cpu, GetParam()), got = pool(*gpu->device, GetParam());
    ASSERT_TRUE(expected && got);
    const int there = settle(*expected), here = settle(*got);
    ASSERT_LT(there, 300);
    ASSERT_LT(here, 300);
    EXPECT_NEAR(here, there, 31) << "frames: half a second, after which it is asked again whether water is calm";
    // Particles end elsewhere by rounding, but the water is the same.
    const FluidStats &f = got->stats(), &e = expected->stats();
    EXPECT_EQ(f.particles, e.particles);
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(f.centreOfMass[axis], e.centreOfMass[axis], 0.03 * kSpacing);
    EXPECT_NEAR(f.avgCompression, e.avgCompression, 1.0e-3);
    const std::vector<vec4> a = byId(*got);
    // It stays as it is, bit for bit.
    for (int k = 0; k < 5; ++k) got->step({}, 1.0 / 60);
    EXPECT_EQ(byId(*got), a);
    // And wakes.
    for (int k = 0; k < 12; ++k) {
        got->step({.gravity = vec3(4, -9, 0)}, 1.0 / 60);
        gpu->device->finish();
        gpu->device->poll();
    }
    EXPECT_EQ(got->stats().asleep, 0U);
    EXPECT_GT(got->stats().maxSpeed, 0.1);
    EXPECT_EQ(got->stats().lost, 0U);
}

INSTANTIATE_TEST_SUITE_P(Devices, SleepParity,
                         testing::Values(Case{"gl", "pbf", false, 0.2F}, Case{"gl", "pbf", false, 0.1F}, Case{"cl", "dfsph", true, 0.2F},
                                         Case{"cl", "wcsph", false, 0.2F}),
                         [](const auto& of) {
                             return fmt::format("{}_{}_jitter{:.0f}", of.param.device, of.param.method, 100 * of.param.jitter);
                         });

}  // namespace
}  // namespace rivulet::sleep_parity_test
