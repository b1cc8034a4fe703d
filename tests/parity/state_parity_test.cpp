// A state that was saved on the cpu continues on a GPU; positions drawn between two steps are the same.
#include <gtest/gtest.h>

#include <cmath>

#include "fluid/sim/world/fluid_world.h"
#include "tests/parity/devices.h"

namespace rivulet::state_parity_test {
namespace {

FluidParams block(const char* method) {
    FluidParams p;
    p.method = method;
    p.spacing = 0.05F;
    p.fixedStep = 0.01F;
    p.blocks = {{vec3(0.0F), vec3(0.5F, 0.6F, 0.5F), vec3(0.0F)}};
    return p;
}

std::vector<vec4> byId(FluidWorld& world, const Buffer& buffer) {
    const uint32_t n = world.particles().count;
    const std::vector<vec4> values = world.device().readAll<vec4>(buffer, n);
    const std::vector<uint32_t> id = world.device().readAll<uint32_t>(*world.particles().id, n);
    std::vector<vec4> sorted(n);
    for (uint32_t i = 0; i < n; ++i) sorted[id[i]] = values[i];
    return sorted;
}

double furthest(const std::vector<vec4>& a, const std::vector<vec4>& b) {
    double worst = a.size() == b.size() ? 0 : 1e30;
    for (size_t i = 0; i < std::min(a.size(), b.size()); ++i) worst = std::max(worst, double{glm::length(vec3(a[i] - b[i]))});
    return worst;
}

class StateParity : public testing::TestWithParam<const char*> {};

TEST_P(StateParity, SavedOnTheCpuResumedThere) {
    Result<TestGpu> gpu = makeTestGpu(GetParam());
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    const std::unique_ptr<Device> cpu = makeTestCpu();
    for (const char* method : {"wcsph", "pbf", "dfsph"}) {
        const FluidParams p = block(method);
        auto here = FluidWorld::create(*cpu, p, {}, {}), there = FluidWorld::create(*gpu->device, p, {}, {});
        ASSERT_TRUE(here && there);
        for (int k = 0; k < 10; ++k) (*here)->step({.gravity = p.gravity}, 1.0 / 60);
        WorldState state;
        (*here)->save(state);
        const Status done = (*there)->restore(state);
        ASSERT_TRUE(done) << method << done.error().message;
        EXPECT_EQ(furthest(byId(**here, *(*here)->particles().position), byId(**there, *(*there)->particles().position)), 0.0) << method;
        for (int k = 0; k < 2; ++k)
            for (FluidWorld* w : {here->get(), there->get()}) w->step({.gravity = p.gravity}, 0.0137);
        EXPECT_EQ((*here)->time(), (*there)->time()) << method;
        EXPECT_EQ((*here)->pending(), (*there)->pending()) << method;
        const double apart = furthest(byId(**here, *(*here)->particles().position), byId(**there, *(*there)->particles().position));
        // After two more steps the results differ only by rounding and by the iterations that a GPU chooses from late figures.
        EXPECT_LT(apart, 0.1 * double{p.spacing}) << method;
        // Drawn between the steps, from its own states.
        const double between = furthest(byId(**here, *(*here)->particles().drawn), byId(**there, *(*there)->particles().drawn));
        EXPECT_LE(between, 1.01 * apart + 1e-6) << method;
        EXPECT_GT(furthest(byId(**there, *(*there)->particles().drawn), byId(**there, *(*there)->particles().position)), 1e-3) << method;
        // In the other direction, too: the cpu restores a state saved on a GPU.
        WorldState back;
        (*there)->save(back);
        EXPECT_TRUE((*here)->restore(back)) << method;
        EXPECT_EQ(furthest(byId(**here, *(*here)->particles().position), byId(**there, *(*there)->particles().position)), 0.0) << method;
    }
}

// Results that are pending when their world is destroyed are dropped: neither it nor the next world of that device receives them.
TEST_P(StateParity, AWorldMayBeDestroyedBeforeItsResultsArrive) {
    Result<TestGpu> gpu = makeTestGpu(GetParam());
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    const FluidParams p = block("wcsph");
    FluidParams few = p;
    few.blocks[0].max = vec3(0.2F);
    {
        auto gone = FluidWorld::create(*gpu->device, p, {}, {});
        ASSERT_TRUE(gone);
        for (int k = 0; k < 2; ++k) (*gone)->step({.gravity = p.gravity}, 1.0 / 60);
    }
    auto next = FluidWorld::create(*gpu->device, few, {}, {});
    ASSERT_TRUE(next);
    gpu->device->finish();
    gpu->device->poll();
    EXPECT_EQ((*next)->stats().particles, 64U);
    EXPECT_EQ((*next)->stats().time, 0.0);
    for (int k = 0; k < 2; ++k) (*next)->step({.gravity = p.gravity}, 1.0 / 60);
    gpu->device->finish();
    gpu->device->poll();
    EXPECT_EQ((*next)->stats().particles, 64U);
    EXPECT_GT((*next)->stats().time, 0.0);
}

INSTANTIATE_TEST_SUITE_P(Devices, StateParity, testing::Values("cl", "gl"), [](const auto& row) { return std::string(row.param); });

}  // namespace
}  // namespace rivulet::state_parity_test
