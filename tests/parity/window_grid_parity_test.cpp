// A grid that covers a part of a box of 1 km and follows the water, on cl and gl: the water is where it is on the cpu.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/parity/devices.h"

namespace rivulet::window_grid_parity_test {
namespace {

constexpr float kSpacing = 0.1F;
// Floats of 512 m to 1 km are 2^-14 m apart.
constexpr double kRounding = 0.5 / 16384;

// The same number of substeps on every device: a GPU reads speeds back late.
FluidParams inAKilometre() {
    FluidParams p;
    p.method = "pbf";
    p.spacing = kSpacing;
    p.box.max = vec3(1000, 100, 1000);
    p.pbf.minSubsteps = 10;
    p.pbf.reach = 1;
    return p;
}

struct Seen {
    std::vector<vec3> places;
    FluidStats stats;
    size_t bytes = 0;
};

// `late`: the test does not wait for the device, so the bounds of the particles arrive some frames late.
Seen run(Device& device, const FluidParams& p, const Sources& sources, int frames, bool late) {
    Seen seen;
    auto world = FluidWorld::create(device, p, {}, {}, sources);
    EXPECT_TRUE(world) << (world ? "" : world.error().message);
    if (!world) return seen;
    for (int k = 0; k < frames; ++k) {
        (*world)->step({}, 1.0 / 60);
        if (late) continue;
        device.finish();
        device.poll();
    }
    device.finish();
    device.poll();
    seen.places = positions(**world);
    seen.stats = (*world)->stats();
    seen.bytes = device.bytesAllocated();
    return seen;
}

// From each place of `a` to the nearest one of `b`, m, the largest.
double apart(const std::vector<vec3>& a, const std::vector<vec3>& b) {
    double worst = 0;
    for (const vec3& x : a) {
        float least = 1.0e9F;
        for (const vec3& y : b) least = std::min(least, glm::distance(x, y));
        worst = std::max(worst, double{least});
    }
    return worst;
}

void expectSame(const Seen& a, const Seen& b, int substeps) {
    ASSERT_EQ(a.places.size(), b.places.size());
    EXPECT_EQ(a.stats.lost, 0U);
    EXPECT_EQ(b.stats.lost, 0U);
    EXPECT_EQ(a.stats.emitted, b.stats.emitted);
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(a.stats.centreOfMass[axis], b.stats.centreOfMass[axis], substeps * kRounding);
    EXPECT_NEAR(a.stats.kinetic / b.stats.kinetic, 1, 0.01);
    // A tenth of a spacing, after splashing.
    EXPECT_LT(apart(a.places, b.places), 0.1 * double{kSpacing});
    EXPECT_LT(apart(b.places, a.places), 0.1 * double{kSpacing});
    // The whole box would have 83 thousand million cells.
    EXPECT_LT(b.bytes, size_t{96} << 20U);
}

class WindowGridParity : public testing::TestWithParam<const char*> {};

// A jet, across 14 m: the window grows with it.
TEST_P(WindowGridParity, AStreamFlowsAsOnTheCpu) {
    Result<TestGpu> gpu = makeTestGpu(GetParam());
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    auto cpu = makeTestCpu();
    Emitter jet;
    jet.params.position = vec3(700, 50, 600);
    jet.params.direction = vec3(1, 0.3F, -0.5F);
    jet.params.litresPerSecond = 1500;
    jet.params.radius = 0.16F;
    jet.params.speed = 20;
    const Sources sources{.emitters = {jet}, .seconds = 1};
    const Seen a = run(*cpu, inAKilometre(), sources, 40, false), b = run(*gpu->device, inAKilometre(), sources, 40, false);
    ASSERT_GT(a.places.size(), 600U);
    expectSame(a, b, 400);
    vec3 low(1.0e9F), high(-1.0e9F);
    for (const vec3& x : b.places) {
        low = glm::min(low, x);
        high = glm::max(high, x);
    }
    EXPECT_GT(glm::distance(low, high), 10) << "many times the width of a cell";
}

// A drop that flies 15 m, whole windows away from where it was, while its bounds arrive late.
TEST_P(WindowGridParity, ADropThatFliesIsFollowed) {
    Result<TestGpu> gpu = makeTestGpu(GetParam());
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    auto cpu = makeTestCpu();
    FluidParams p = inAKilometre();
    p.blocks = {{.min = vec3(800, 50, 600), .max = vec3(800.8F, 50.8F, 600.8F), .velocity = vec3(30, 5, -20)}};
    p.blocks[0].jitter = 0;  // pairs that press on each other make more of the rounding than a tenth of a spacing
    const Seen a = run(*cpu, p, {}, 25, false), b = run(*gpu->device, p, {}, 25, true);
    ASSERT_EQ(a.places.size(), 512U);
    EXPECT_NEAR(a.stats.centreOfMass[0], 812.9, 0.05);
    expectSame(a, b, 350);
}

INSTANTIATE_TEST_SUITE_P(Devices, WindowGridParity, testing::Values("cl", "gl"), [](const auto& row) { return std::string(row.param); });

}  // namespace
}  // namespace rivulet::window_grid_parity_test
