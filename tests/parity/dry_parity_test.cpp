// Volumes that stay dry: on every device nothing is in them after a step, and what is removed is counted.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "fluid/sim/solids/body_shapes.h"
#include "fluid/sim/sources/dry.h"
#include "shaders/fluid/solids/body_state.h"
#include "tests/parity/devices.h"
#include "tests/parity/late_device.h"

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
// A ball carries a box and an ellipsoid through a pool, turning, and is hit by the water; the device is two frames behind, so that the host
// knows only about where the ball is. After each frame no particle is in the volumes where the ball really is, no frame has waited for it,
// and about as many are removed as on the cpu.
TEST_P(DryParity, VolumesMoveWithABody) {
    Result<TestGpu> gpu = makeTestGpu(GetParam());
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    FluidParams p;
    p.method = "pbf";
    p.spacing = 0.05F;
    p.box.max = vec3(1.2F, 0.9F, 0.6F);
    p.blocks = {{vec3(0), vec3(1.2F, 0.4F, 0.6F), vec3(0.0F)}};
    p.fixedStep = 1.0F / 240;
    Solids solids;
    solids.bodies.resize(1);
    Body& ball = solids.bodies[0];
    ball.shape = sphereShape(0.1F, 900, 0.05F);
    ball.state = {{vec3(0.3F, 0.65F, 0.3F), glm::angleAxis(0.5F, glm::normalize(vec3(1, 2, 3)))}, vec3(1.5F, 0, 0), vec3(0, 2, 5)};
    const Sources sources{
        .dry = {{.position = vec3(0.3F, 0.65F, 0.3F), .rotation = vec3(0, 30, 20), .size = vec3(0.3F, 0.1F, 0.1F), .body = 0},
                {.shape = "ellipsoid", .position = vec3(0.4F, 0.75F, 0.3F), .size = vec3(0.2F, 0.15F, 0.25F), .body = 0}}};
    LateDevice late(*gpu->device, 1);
    const auto cpu = makeTestCpu();
    auto world = FluidWorld::create(late, p, solids, {}, sources), host = FluidWorld::create(*cpu, p, solids, {}, sources);
    ASSERT_TRUE(world && host);
    const std::vector<DryVolume> start = (*world)->dry();
    double off = 0;
    for (int frame = 0; frame < 40; ++frame) {
        (*world)->step({.gravity = p.gravity}, 1.0 / 60);
        (*host)->step({.gravity = p.gravity}, 1.0 / 60);
        late.frameEnds();
        const DeviceBody& row = late.rows.back()[0];
        const Pose now{vec3(row.position), quat(row.rotation.w, row.rotation.x, row.rotation.y, row.rotation.z)};
        // Back to where they began, by the ball's motion since.
        const auto before = [&](const vec3& x) { return ball.state.pose.toWorld(now.toOwn(x)); };
        std::vector<DryVolume> volumes = start;
        for (DryVolume& v : volumes) v.reach *= 0.999F;  // the GPU rounds otherwise
        EXPECT_TRUE(std::ranges::none_of(positions(**world), [&](const vec3& x) { return isDry(volumes, before(x)); }))
            << "frame " << frame;
        off = std::max(off, double{glm::length((*world)->expectedBodies()[0].pose.position - now.position)});
    }
    EXPECT_EQ((*world)->stats().bodyWaits, 0U);
    EXPECT_GT(off, 1.0e-3) << "the host does not know where the ball is";
    const double particle = std::pow(double{p.spacing}, 3);
    const double b = static_cast<double>(positions(**host).size()) - static_cast<double>(positions(**world).size()),
                 a = (*host)->stats().drained / particle;
    std::printf("%s: removed %.0f on the cpu, %.0f more or less on the GPU; the ball expected to %.1e m\n", GetParam(), a, b, off);
    EXPECT_GT(a, 40);
    EXPECT_NEAR(b, 0, 0.1 * a);
}

INSTANTIATE_TEST_SUITE_P(Devices, DryParity, testing::Values("gl", "cl"), [](const auto& row) { return std::string(row.param); });

}  // namespace
}  // namespace rivulet::dry_parity_test
