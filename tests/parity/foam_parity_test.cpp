// Foam on cl and gl: the amount and its mean position agree with the cpu.
#include <gtest/gtest.h>

#include <cmath>

#include "fluid/sim/world/fluid_world.h"
#include "tests/parity/devices.h"

namespace rivulet::foam_parity_test {
namespace {

struct Cloud {
    double count = 0;
    dvec3 middle{0.0};
};

Cloud afterASplash(Device& device) {
    FluidParams p;
    p.method = "pbf";
    p.spacing = 0.025F;
    p.pbf.minSubsteps = 8;  // the same number on every device: a GPU reads speeds back late
    p.box.max = vec3(1.0F, 1.0F, 0.5F);
    p.blocks = {{vec3(0.0F), vec3(1.0F, 0.1F, 0.5F), vec3(0.0F)}, {vec3(0.0F, 0.1F, 0.0F), vec3(0.3F, 0.7F, 0.5F), vec3(0.0F)}};
    p.foam.most = 20000;
    p.foam.trappedAir = p.foam.waveCrest = 300;
    auto world = FluidWorld::create(device, p, {}, {});
    EXPECT_TRUE(world) << (world ? "" : world.error().message);
    Cloud cloud;
    if (!world) return cloud;
    for (int k = 0; k < 24; ++k) {
        (*world)->step({}, 1.0 / 60);
        device.finish();
        device.poll();
    }
    const ParticleView view = (*world)->particles();
    const auto slots = device.readAll<vec4>(*view.foam, view.foamSlots);
    for (size_t k = 0; k < view.foamSlots; ++k) {
        if (!(slots[k].w > 0)) continue;
        cloud.count += 1;
        cloud.middle += dvec3(slots[k]);
    }
    cloud.middle /= std::max(cloud.count, 1.0);
    return cloud;
}

class FoamParity : public testing::TestWithParam<const char*> {};

TEST_P(FoamParity, TheSameAmountInTheSamePlaces) {
    Result<TestGpu> gpu = makeTestGpu(GetParam());
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    auto cpu = makeTestCpu();
    const Cloud a = afterASplash(*cpu), b = afterASplash(*gpu->device);
    ASSERT_GT(a.count, 200);
    EXPECT_NEAR(b.count / a.count, 1.0, 0.05);
    EXPECT_LT(glm::distance(a.middle, b.middle), 0.02);
}

INSTANTIATE_TEST_SUITE_P(Devices, FoamParity, testing::Values("cl", "gl"), [](const auto& row) { return std::string(row.param); });

}  // namespace
}  // namespace rivulet::foam_parity_test
