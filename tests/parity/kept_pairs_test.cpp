// Which neighbours are within reach, kept by a GPU's first sweep of a step: later sweeps of all forms of rows agree with the cpu.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "fluid/sim/world/fluid_world.h"
#include "fluid/sim/world/host_particles.h"
#include "tests/parity/devices.h"

namespace rivulet::kept_pairs_test {
namespace {

constexpr float kSpacing = 0.05F;

struct Case {
    const char* device;
    const char* method;
    float support;    // spacings
    bool iterations;  // more of them than by default
};

struct After {
    std::vector<vec4> position, velocity;  // by id
};

After stateAfter(Device& device, const Case& c) {
    FluidParams p;
    p.method = c.method;
    p.spacing = kSpacing;
    p.supportSpacings = c.support;
    p.soundSpeed = 15;
    p.box.max = vec3(1.0F, 1.2F, 1.0F);
    // Two columns: one against a corner, with images in three walls; one in the air.
    p.blocks = {{vec3(0.0F), vec3(0.4F, 0.6F, 0.4F), vec3(0.0F)},
                {vec3(0.5F, 0.4F, 0.5F), vec3(0.9F, 0.8F, 0.9F), vec3(0.3F, -1.0F, 0.2F)}};
    p.pbf.reach = p.dfsph.reach = 1;
    p.pbf.iterations = p.dfsph.maxIterations = c.iterations ? 6 : 3;
    p.dfsph.tolerance = 1.0e-6F;
    Result<std::unique_ptr<FluidWorld>> world = FluidWorld::create(device, p, {}, {});
    EXPECT_TRUE(world) << (world ? "" : world.error().message);
    if (!world) return {};
    for (int k = 0; k < 3; ++k) (*world)->step({.gravity = p.gravity}, 1.0 / 1600);
    const HostParticles now = readParticles(**world);
    After after;
    after.position.assign(now.id.size(), vec4(std::numeric_limits<float>::quiet_NaN()));
    after.velocity = after.position;
    for (size_t i = 0; i < now.id.size(); ++i) {
        EXPECT_LT(now.id[i], now.id.size());
        if (now.id[i] >= now.id.size()) continue;
        after.position[now.id[i]] = now.position[i];
        after.velocity[now.id[i]] = now.velocity[i];
    }
    return after;
}

class KeptPairs : public testing::TestWithParam<Case> {};

// A row holds up to 36 neighbours with a support of 2.3 spacings, 64 or more with 3, and 129 with 3.5, of which the bits of 64 are kept.
// After three steps particles are where they are on the cpu, to a thousandth of a spacing, and as fast, to a twentieth of the 0.02 m/s that
// gravity has given them: the order of additions differs, and pbf takes velocities from positions, whose rounding in a metre, 1.2e-7 m, is
// 2e-4 m/s in a step.
TEST_P(KeptPairs, LaterSweepsAgreeWithTheCpu) {
    const Case& c = GetParam();
    Result<TestGpu> gpu = makeTestGpu(c.device);
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    const std::unique_ptr<Device> cpu = makeTestCpu();
    const After expected = stateAfter(*cpu, c), got = stateAfter(*gpu->device, c);
    ASSERT_GT(expected.position.size(), 1000U);
    ASSERT_EQ(expected.position.size(), got.position.size());
    float apart = 0, faster = 0;
    for (size_t k = 0; k < expected.position.size(); ++k) {
        ASSERT_TRUE(std::isfinite(glm::length(got.position[k]) + glm::length(got.velocity[k]))) << k;
        apart = std::max(apart, glm::length(vec3(expected.position[k]) - vec3(got.position[k])));
        faster = std::max(faster, glm::length(vec3(expected.velocity[k]) - vec3(got.velocity[k])));
    }
    EXPECT_LT(apart, 1.0e-3F * kSpacing);
    EXPECT_LT(faster, 1.0e-3F);
}

std::string nameOf(const testing::TestParamInfo<Case>& row) {
    const Case& c = row.param;
    return std::string(c.device) + "_" + c.method + "_" + std::to_string(static_cast<int>(10 * c.support)) + (c.iterations ? "_more" : "");
}
INSTANTIATE_TEST_SUITE_P(Devices, KeptPairs,
                         testing::Values(Case{"cl", "wcsph", 2.3F, false}, Case{"cl", "wcsph", 3.5F, false}, Case{"cl", "pbf", 2.3F, true},
                                         Case{"cl", "pbf", 3.5F, false}, Case{"cl", "dfsph", 2.3F, true}, Case{"cl", "dfsph", 3.5F, false},
                                         Case{"gl", "wcsph", 2.3F, false}, Case{"gl", "wcsph", 3.0F, false}, Case{"gl", "pbf", 2.3F, true},
                                         Case{"gl", "pbf", 3.5F, false}, Case{"gl", "dfsph", 2.3F, true}, Case{"gl", "dfsph", 3.5F, false}),
                         nameOf);

}  // namespace
}  // namespace rivulet::kept_pairs_test
