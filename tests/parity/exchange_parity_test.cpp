// Exchange of water with a world on cl and gl: the same numbers of particles are removed and spawned as on the cpu.
#include <gtest/gtest.h>

#include "fluid/sim/world/fluid_world.h"
#include "tests/parity/devices.h"

namespace rivulet::exchange_parity_test {
namespace {

constexpr double kOne = 0x1p-15;  // m^3, of a particle

class ExchangeParity : public testing::TestWithParam<const char*> {};

TEST_P(ExchangeParity, TheSameOnAGpu) {
    Result<TestGpu> gpu = makeTestGpu(GetParam());
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    auto cpu = makeTestCpu();
    std::vector<vec3> left[2];
    FluidStats stats[2];
    Device* devices[] = {cpu.get(), gpu->device.get()};
    for (size_t d = 0; d < 2; ++d) {
        FluidParams p;
        p.spacing = 0.03125F;
        p.box.max = vec3(0.5F);
        p.blocks = {{vec3(0.0F), vec3(0.5F, 0.2F, 0.5F), vec3(0.0F)}};
        p.method = "pbf";
        p.pbf.minSubsteps = 4;
        auto made = FluidWorld::create(*devices[d], p, {}, {}, {.expectedDeposit = 100 * kOne});
        ASSERT_TRUE(made) << made.error().message;
        FluidWorld& world = **made;
        for (int k = 0; k < 2; ++k) world.step({}, 1.0 / 60);
        std::vector<uint32_t> slots;
        for (const WorldParticle& particle : world.within({vec3(0.1F, 0.05F, 0.1F), vec3(0.3F, 0.5F, 0.3F)}))
            slots.push_back(particle.slot);
        world.withdraw(slots);
        world.deposit(vec3(0.4F, 0.3F, 0.4F), vec3(0, -1, 0), 1.5 * kOne);
        world.step({}, 1.0 / 60);
        devices[d]->finish();
        devices[d]->poll();
        left[d] = positions(world);
        stats[d] = world.stats();
    }
    EXPECT_EQ(left[0].size(), left[1].size());
    EXPECT_GT(stats[0].withdrawn, 0.0);
    EXPECT_EQ(stats[0].withdrawn, stats[1].withdrawn);
    EXPECT_EQ(stats[0].deposited, kOne);
    EXPECT_EQ(stats[1].deposited, kOne);
    EXPECT_NEAR(stats[1].pendingVolume, 0.5 * kOne, 1e-15);
}

INSTANTIATE_TEST_SUITE_P(Devices, ExchangeParity, testing::Values("cl", "gl"), [](const auto& row) { return std::string(row.param); });

}  // namespace
}  // namespace rivulet::exchange_parity_test
