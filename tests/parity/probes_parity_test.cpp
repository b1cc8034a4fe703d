// Loads on cl and gl: the balance of momentum on the device, and the same loads as on the cpu.
#include <gtest/gtest.h>

#include "fluid/sim/solids/body_shapes.h"
#include "tests/parity/devices.h"
#include "tests/physics/baked_mesh.h"
#include "tests/physics/loads.h"

namespace rivulet::probes_parity_test {
namespace {

struct Row {
    const char *device, *method;
};
void PrintTo(const Row& row, std::ostream* out) { *out << row.method << " on " << row.device; }

class ProbesParity : public testing::TestWithParam<Row> {};

// A slope, an obstacle, a paddle and a ball in no-slip water that also sticks: every kernel of the probes runs.
struct Scene {
    FluidParams params;
    VoxelField step, paddle;
    Pose pose{vec3(0.5F, 0.3F, 0.1F), quat(1, 0, 0, 0)};
    Body ball;
    Solids solids;

    explicit Scene(const char* method) {
        const float s = 0.025F;
        params.method = method;
        params.spacing = s;
        params.box.max = vec3(0.6F, 0.6F, 0.2F);
        params.blocks = {{vec3(0.0F, 0.05F, 0.0F), vec3(0.2F, 0.25F, 0.2F)}};
        params.soundSpeed = 15;
        params.cfl = 0.8F;
        params.viscosity = 1.0e-3F;
        params.forces.viscosity = "explicit";
        params.forces.adhesion = 0.2F;
        params.collision.walls = "no-slip";
        params.collision.friction = 0.1F;
        step = test::baked(test::makeBox(vec3(0.3F, -0.1F, 0.05F), vec3(0.35F, 0.1F, 0.15F)), 0.25F * s, s);
        paddle = test::baked(test::makeBox(vec3(-0.03F, -0.2F, -0.3F), vec3(0.03F, 0.2F, 0.3F)), 0.25F * s, s);
        ball.shape = sphereShape(2 * s, 400, s);
        ball.state.pose.position = vec3(0.1F, 0.35F, 0.1F);
        solids = {
            .field = &step, .planes = {{vec3(0.0F, 0.02F, 0.1F), vec3(0.05F, 1.0F, 0.1F)}}, .rigid = {{&paddle, pose}}, .bodies = {ball}};
        params.probes = test::probesOfAll(solids);
    }
    test::Balance run(Device& device, int frames) {
        auto world = FluidWorld::create(device, params, solids, {});
        EXPECT_TRUE(world) << (world ? "" : world.error().message);
        if (!world) return {.missing = 1.0e9};
        Pose at = pose;
        return test::balanceOf(**world, frames, [&](int) {
            at.position.x -= 0.006F;
            return FluidInputs{.poses = std::span(&at, 1)};
        });
    }
};

TEST_P(ProbesParity, TheSumOfAllImpulsesIsTheChangeOfMomentum) {
    Result<TestGpu> gpu = makeTestGpu(GetParam().device);
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    Scene scene(GetParam().method);
    const test::Balance there = scene.run(*gpu->device, 8);
    auto cpu = makeTestCpu();
    const test::Balance here = scene.run(*cpu, 8);
    std::printf("%s on %s: missing %.2e, on the cpu %.2e\n", GetParam().method, GetParam().device, there.missing, here.missing);
    EXPECT_LT(there.missing, 1.0e-3);
    ASSERT_EQ(there.impulses.size(), here.impulses.size());
    for (size_t k = 0; k < here.impulses.size(); ++k)
        EXPECT_LT(glm::length(there.impulses[k] - here.impulses[k]), 0.02 * here.scale) << scene.params.probes[k].name;
}

INSTANTIATE_TEST_SUITE_P(Devices, ProbesParity,
                         testing::Values(Row{"cl", "dfsph"}, Row{"gl", "dfsph"}, Row{"cl", "pbf"}, Row{"gl", "pbf"}, Row{"cl", "wcsph"},
                                         Row{"gl", "wcsph"}),
                         [](const auto& row) { return std::string(row.param.device) + "_" + row.param.method; });

}  // namespace
}  // namespace rivulet::probes_parity_test
