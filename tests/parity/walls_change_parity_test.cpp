// Walls and emitters that are added and removed: the same on every device.
#include <gtest/gtest.h>

#include <cmath>

#include "fluid/sim/world/host_particles.h"
#include "tests/parity/devices.h"
#include "tests/physics/baked_mesh.h"

namespace rivulet::walls_change_parity_test {
namespace {

constexpr float kSpacing = 0.05F;

VoxelField box(const vec3& low, const vec3& high) { return test::baked(test::makeBox(low, high), 0.25F * kSpacing, kSpacing); }

struct Outcome {
    size_t before = 0, after = 0;
    dvec3 centre{0.0};
    double drained = 0, emitted = 0;  // m^3
};

// A gate opens while a block is added in the water behind it; then an emitter begins.
Outcome run(Device& device) {
    FluidParams p;
    p.spacing = kSpacing;
    p.box.max = vec3(1.0F, 0.6F, 0.25F);
    p.maxParticles = 1000;
    p.blocks = {{.min = vec3(0.0F), .max = vec3(0.3F, 0.4F, 0.25F)}};
    const VoxelField gate = box(vec3(0.325F, -0.1F, -0.1F), vec3(0.4F, 0.7F, 0.35F)),
                     block = box(vec3(0.1F, 0.1F, 0.05F), vec3(0.2F, 0.25F, 0.2F));
    auto world = FluidWorld::create(device, p, {.rigid = {{&gate, {}}}}, {});
    EXPECT_TRUE(world) << (world ? "" : world.error().message);
    const auto steps = [&](int count) {
        for (int k = 0; k < count; ++k) (*world)->step({}, 1.0 / 60);
        device.finish();
        device.poll();
    };
    steps(5);
    Outcome out;
    out.before = positions(**world).size();
    EXPECT_TRUE((*world)->setWalls({.field = &block}));
    steps(10);
    Sources sources;
    sources.emitters.resize(1);
    sources.emitters[0].params.position = vec3(0.8F, 0.5F, 0.12F);
    sources.emitters[0].params.litresPerSecond = 5;
    EXPECT_TRUE((*world)->setSources(sources));
    steps(10);
    steps(1);
    const std::vector<vec3> all = positions(**world);
    out.after = all.size();
    for (const vec3& at : all) out.centre += dvec3(at) / static_cast<double>(all.size());
    out.drained = (*world)->stats().drained;
    out.emitted = (*world)->stats().emitted;
    return out;
}

void matchesTheCpu(const char* name) {
    Result<TestGpu> gpu = makeTestGpu(name);
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    const Outcome expected = run(*makeTestCpu()), got = run(*gpu->device);
    EXPECT_LT(expected.after, expected.before + 30);
    EXPECT_EQ(got.before, expected.before);
    EXPECT_EQ(got.after, expected.after);
    EXPECT_NEAR(got.drained, expected.drained, 1.0e-9);
    EXPECT_NEAR(got.emitted, expected.emitted, 1.0e-9);
    EXPECT_LT(glm::length(got.centre - expected.centre), 0.05 * double{kSpacing});
}

TEST(WallsChangeParity, OpenGlMatchesCpu) { matchesTheCpu("gl"); }
TEST(WallsChangeParity, OpenClMatchesCpu) { matchesTheCpu("cl"); }

}  // namespace
}  // namespace rivulet::walls_change_parity_test
