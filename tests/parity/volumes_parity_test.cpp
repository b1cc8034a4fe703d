// Volumes that are watched on cl and gl: exact counts of that device's own particles, some steps late.
#include <gtest/gtest.h>

#include "fluid/sim/world/fluid_world.h"
#include "tests/parity/devices.h"

namespace rivulet::volumes_parity_test {
namespace {

class VolumesParity : public testing::TestWithParam<const char*> {};

TEST_P(VolumesParity, CountsEqualTheParticlesInside) {
    Result<TestGpu> gpu = makeTestGpu(GetParam());
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    FluidParams p;
    p.method = "pbf";
    p.spacing = 0.03125F;
    p.box.max = vec3(0.5F);
    p.blocks = {{vec3(0.0F), vec3(0.1875F, 0.4F, 0.5F), vec3(0.0F)}};
    Sources sources;
    sources.sinks.push_back({.shape = "box", .position = vec3(0.45F, 0.05F, 0.25F), .size = vec3(0.1F, 0.1F, 0.5F)});
    auto made = FluidWorld::create(*gpu->device, p, {}, {}, sources);
    ASSERT_TRUE(made) << made.error().message;
    FluidWorld& world = **made;
    std::vector<Volume> volumes = {{1, Volume::box, vec3(0.35F, 0.1F, 0.25F), vec3(0.2F, 0.2F, 0.4F)},
                                   {2, Volume::sphere, vec3(0.1F, 0.2F, 0.2F), {}, 0.12F}};
    uint64_t entered[2] = {0, 0}, left[2] = {0, 0};
    for (int frame = 0; frame < 30; ++frame) {
        volumes[1].position.x += 0.008F;
        ASSERT_TRUE(world.setVolumes(volumes));
        if (frame == 10) {  // a third volume is added and removed, and reuses their bits
            volumes.push_back({3, Volume::box, vec3(0.25F), vec3(1.0F)});
            ASSERT_TRUE(world.setVolumes(volumes));
            volumes.pop_back();
            ASSERT_TRUE(world.setVolumes(volumes));
        }
        world.step({}, 1.0 / 60);
        for (const VolumeCount& e : world.takeVolumeEvents()) {
            entered[e.id - 1] += e.entered;
            left[e.id - 1] += e.left;
            EXPECT_EQ(e.inside, entered[e.id - 1] - left[e.id - 1]);
        }
    }
    gpu->device->finish();
    gpu->device->poll();
    const std::vector<VolumeCount> counts = world.volumes();
    const std::vector<vec3> all = positions(world);
    size_t inBox = 0, inBall = 0;
    for (const vec3& x : all) {
        const vec3 d = glm::abs(x - volumes[0].position);
        inBox += d.x <= 0.1F && d.y <= 0.1F && d.z <= 0.2F ? 1 : 0;
        inBall += glm::distance(x, volumes[1].position) <= volumes[1].radius ? 1 : 0;
    }
    EXPECT_EQ(counts[0].inside, inBox);
    EXPECT_EQ(counts[1].inside, inBall);
    EXPECT_EQ(counts[0].time, world.time());
    EXPECT_GT(counts[1].left, 50U);
    EXPECT_GT(counts[0].entered, 50U);
    for (const VolumeCount& c : counts) EXPECT_EQ(c.inside, c.entered - c.left);
}

INSTANTIATE_TEST_SUITE_P(Devices, VolumesParity, testing::Values("cl", "gl"), [](const auto& row) { return std::string(row.param); });

}  // namespace
}  // namespace rivulet::volumes_parity_test
