// Emitters and sinks on cl and gl: as many particles as on the cpu, and in the same places. Which slot and id a particle gets may differ:
// a GPU has free slots in no fixed order.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "fluid/sim/world/fluid_world.h"
#include "tests/parity/devices.h"

namespace rivulet::emitter_parity_test {
namespace {

struct Seen {
    std::vector<vec3> position;
    std::vector<float> row, red;  // of the liquid; absorption of red
    FluidStats stats;
};

Seen twelveFrames(Device& device) {
    Seen seen;
    FluidParams p;
    p.method = "pbf";
    p.spacing = 0.025F;
    p.pbf.minSubsteps = 10;  // the same number on every device: a GPU reads speeds back late
    p.blocks = {{vec3(0.0F), vec3(1.0F, 0.1F, 1.0F), vec3(0.0F)}};
    Emitter jet, rain;
    jet.params.litresPerSecond = 3;
    jet.params.speed = 1.5F;
    jet.params.position = vec3(0.3F, 0.9F, 0.3F);
    jet.params.direction = vec3(1, 0.5F, 1);
    jet.params.dye = vec3(0.2F, 1, 1);
    rain.params.shape = "box";
    rain.params.liquid = "oil";
    rain.params.litresPerSecond = 1;
    rain.params.speed = 1;  // slow, so that no place is blocked: the cpu offers a refused particle again at once, a GPU some frames later
    rain.params.size = vec3(0.3F);
    rain.params.position = vec3(0.7F, 0.6F, 0.2F);
    SinkParams sink;
    sink.position = vec3(0.1F, 0.05F, 0.1F);
    sink.size = vec3(0.21F);
    auto world = FluidWorld::create(device, p, {}, {}, {.emitters = {jet, rain}, .sinks = {sink}, .seconds = 1});
    EXPECT_TRUE(world) << (world ? "" : world.error().message);
    if (!world) return seen;
    for (int k = 0; k < 12; ++k) {
        (*world)->step({}, 1.0 / 60);
        device.finish();
        device.poll();
    }
    const ParticleView view = (*world)->particles();
    const auto x = device.readAll<vec4>(*view.position, view.count), a = device.readAll<vec4>(*view.absorption, view.count),
               matter = device.readAll<vec4>(*view.matterOf, view.count);
    const auto id = device.readAll<uint32_t>(*view.id, view.count);
    std::vector<size_t> order;
    for (size_t i = 0; i < x.size(); ++i)
        if (x[i].w >= 0) order.push_back(i);
    for (const size_t i : order) {
        seen.position.emplace_back(x[i]);
        seen.row.push_back(matter[id[i]].w);
        seen.red.push_back(a[i].x);
    }
    seen.stats = (*world)->stats();
    return seen;
}

class EmitterParity : public testing::TestWithParam<const char*> {};

TEST_P(EmitterParity, TheSameParticlesAreEmittedAndDrained) {
    Result<TestGpu> gpu = makeTestGpu(GetParam());
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    auto cpu = makeTestCpu();
    const Seen a = twelveFrames(*cpu), b = twelveFrames(*gpu->device);
    ASSERT_GT(a.position.size(), 5000U);
    ASSERT_EQ(a.position.size(), b.position.size());
    EXPECT_EQ(a.stats.emitted, b.stats.emitted);
    EXPECT_EQ(a.stats.drained, b.stats.drained);
    EXPECT_GT(a.stats.drained, 0.0);
    double worst = 0;
    for (size_t i = 0; i < a.position.size(); ++i) {
        size_t nearest = 0;
        float least = 1e9F;
        for (size_t j = 0; j < b.position.size(); ++j)
            if (const float d = glm::length(a.position[i] - b.position[j]); d < least) {
                least = d;
                nearest = j;
            }
        worst = std::max(worst, double{least});
        EXPECT_EQ(a.row[i], b.row[nearest]);
        EXPECT_NEAR(a.red[i], b.red[nearest], 1e-4F);
    }
    EXPECT_LT(worst, 0.1 * 0.025);  // a tenth of a spacing, after 120 steps of splashing
}

// The state that DFSPH stores per particle id is removed with the particle, on all devices.
TEST_P(EmitterParity, TheStateOfADrainedParticleIsCleared) {
    Result<TestGpu> gpu = makeTestGpu(GetParam());
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    Device& device = *gpu->device;
    FluidParams p;
    p.method = "dfsph";
    p.spacing = 0.04F;
    p.box.max = vec3(0.4F);
    p.blocks = {{vec3(0.0F), vec3(0.4F, 0.32F, 0.4F)}};
    SinkParams sink, away;
    sink.position = vec3(0.1F, 0.1F, 0.2F);
    sink.size = vec3(0.2F, 0.2F, 0.4F);
    away.position = vec3(0, -5, 0);
    auto world = FluidWorld::create(device, p, {}, {}, {.sinks = {away}});
    ASSERT_TRUE(world) << world.error().message;
    const auto remembered = [&] {
        WorldState state;
        (*world)->save(state);
        auto pressure = state.take<float>("method.pressure", (*world)->particles().slots);
        EXPECT_TRUE(pressure);
        return *pressure;
    };
    for (int k = 0; k < 2; ++k) (*world)->step({}, 1.0 / 60);
    const std::vector<float> before = remembered();
    ASSERT_TRUE((*world)->setSources({.sinks = {sink}}));
    (*world)->step({}, 1.0 / 60);
    const std::vector<float> after = remembered();
    const ParticleView view = (*world)->particles();
    const auto x = device.readAll<vec4>(*view.position, view.count);
    const auto id = device.readAll<uint32_t>(*view.id, view.count);
    size_t pressed = 0, kept = 0;
    for (size_t i = 0; i < x.size(); ++i) {
        if (x[i].w < 0) EXPECT_EQ(after[id[i]], 0.0F) << id[i];
        pressed += x[i].w < 0 && before[id[i]] > 0 ? 1 : 0;
        kept += x[i].w >= 0 && after[id[i]] > 0 ? 1 : 0;
    }
    EXPECT_GT(pressed, 50U);
    EXPECT_GT(kept, 50U) << "the others' stays";
}

INSTANTIATE_TEST_SUITE_P(Devices, EmitterParity, testing::Values("cl", "gl"), [](const auto& row) { return std::string(row.param); });

}  // namespace
}  // namespace rivulet::emitter_parity_test
