// Volumes that stay dry: on every device nothing is in them after a step, and what is removed is counted.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "fluid/sim/sources/dry.h"
#include "tests/parity/devices.h"

namespace rivulet::dry_parity_test {
namespace {

// The particles that a box and an ellipsoid in the way of a dam break have removed after 20 frames; an emitter points into the box.
double removed(Device& device) {
    FluidParams p;
    p.spacing = 0.04F;
    p.box.max = vec3(1.0F, 0.6F, 0.3F);
    p.maxParticles = 4000;
    p.pbf.minSubsteps = 6;  // the same number on every device: a GPU reads speeds back late
    p.blocks = {{.min = vec3(0.0F), .max = vec3(0.4F, 0.4F, 0.3F)}};
    Sources sources;
    sources.dry = {
        {.position = vec3(0.6F, 0.1F, 0.15F), .rotation = vec3(0, 30, 20), .size = vec3(0.15F, 0.3F, 0.2F)},
        {.shape = "ellipsoid", .position = vec3(0.3F, 0.2F, 0.15F), .rotation = vec3(40, 0, 0), .size = vec3(0.2F, 0.3F, 0.15F)}};
    sources.emitters.resize(1);
    sources.emitters[0].params.position = vec3(0.6F, 0.15F, 0.15F);
    sources.emitters[0].params.litresPerSecond = 5;
    auto world = FluidWorld::create(device, p, {}, {}, sources);
    EXPECT_TRUE(world) << (world ? "" : world.error().message);
    if (!world) return 0;
    const size_t first = positions(**world).size();
    size_t left = first;
    for (int frame = 0; frame <= 20; ++frame) {
        if (frame > 0) (*world)->step({}, 1.0 / 60);
        const std::vector<vec3> all = positions(**world);
        left = all.size();
        // A hair less: the GPU rounds otherwise.
        std::vector<DryVolume> volumes = (*world)->dry();
        for (DryVolume& v : volumes) v.reach *= 0.9999F;
        EXPECT_TRUE(std::ranges::none_of(all, [&](const vec3& x) { return isDry(volumes, x); })) << "frame " << frame;
    }
    device.finish();
    device.poll();
    (*world)->step({}, 1.0e-9);
    device.finish();
    device.poll();
    left = positions(**world).size();
    const double particle = std::pow(double{p.spacing}, 3), drained = (*world)->stats().drained / particle;
    EXPECT_NEAR(drained, static_cast<double>(first - left), 0.01) << "the ledger adds up";
    EXPECT_NEAR((*world)->stats().emitted / particle, static_cast<double>(first), 0.01) << "no particle is emitted into a dry volume";
    return drained;
}

class DryParity : public testing::TestWithParam<const char*> {};
TEST_P(DryParity, RemovesAsOnTheCpu) {
    Result<TestGpu> gpu = makeTestGpu(GetParam());
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    const auto cpu = makeTestCpu();
    const double a = removed(*cpu), b = removed(*gpu->device);
    std::printf("removed %.0f on cpu, %.0f on %s\n", a, b, GetParam());
    EXPECT_GT(a, 100);
    EXPECT_NEAR(b, a, 5) << "rounding takes a few across a border a frame earlier or later";
}
INSTANTIATE_TEST_SUITE_P(Devices, DryParity, testing::Values("gl", "cl"), [](const auto& row) { return std::string(row.param); });

}  // namespace
}  // namespace rivulet::dry_parity_test
