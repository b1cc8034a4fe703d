// Wet surfaces on cl and gl: as on the cpu.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/parity/devices.h"
#include "tests/physics/baked_mesh.h"

namespace rivulet::wetness_parity_test {
namespace {

// A pillar in a pool, half of it under water, and lifted out of it.
std::vector<float> wetPillar(Device& device) {
    FluidParams p;
    p.spacing = 0.025F;
    p.pbf.minSubsteps = 4;
    p.box.max = vec3(0.4F, 0.8F, 0.4F);
    p.blocks = {{vec3(0.0F), vec3(0.4F, 0.2F, 0.4F), vec3(0.0F)}};
    p.wetness.on = true;
    p.wetness.dries = 1;
    const VoxelField pillar = test::baked(test::makeBox(vec3(-0.06F, -0.12F, -0.06F), vec3(0.06F, 0.12F, 0.06F)), 0.01F, p.spacing);
    Pose pose{vec3(0.2F)};
    auto world = FluidWorld::create(device, p, {.rigid = {{&pillar, pose}}}, {});
    EXPECT_TRUE(world) << (world ? "" : world.error().message);
    if (!world) return {};
    for (int k = 0; k < 24; ++k) {
        if (k >= 12) pose.position.y += 0.02F;
        (*world)->step({.poses = std::span(&pose, 1)}, 1.0 / 60);
        device.finish();
        device.poll();
    }
    const WetnessView wet = (*world)->wetness();
    return device.readAll<float>(*wet.values, wet.surface->points.size());
}

class WetnessParity : public testing::TestWithParam<const char*> {};

TEST_P(WetnessParity, TheSamePlacesAreWet) {
    Result<TestGpu> gpu = makeTestGpu(GetParam());
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    auto cpu = makeTestCpu();
    const std::vector<float> a = wetPillar(*cpu), b = wetPillar(*gpu->device);
    ASSERT_EQ(a.size(), b.size());
    double sum = 0, off = 0;
    size_t dry = 0;
    for (size_t k = 0; k < a.size(); ++k) {
        sum += double{a[k]};
        off += std::abs(double{a[k]} - double{b[k]});
        if (a[k] < 0.05F) ++dry;
    }
    EXPECT_GT(sum, 0.2 * static_cast<double>(a.size()));
    EXPECT_GT(dry, a.size() / 10);
    EXPECT_LT(off / sum, 0.03);
}

INSTANTIATE_TEST_SUITE_P(Devices, WetnessParity, testing::Values("cl", "gl"), [](const auto& row) { return std::string(row.param); });

}  // namespace
}  // namespace rivulet::wetness_parity_test
