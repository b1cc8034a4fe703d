// Whole steps with bodies in them: cl and gl leave particles and bodies where the cpu does.
#include <gtest/gtest.h>

#include <cmath>

#include "fluid/sim/solids/body_shapes.h"
#include "fluid/sim/world/fluid_world.h"
#include "tests/parity/devices.h"

namespace rivulet::bodies_parity_test {
namespace {

struct After {
    std::vector<vec4> position, velocity;  // by id
    std::vector<BodyState> bodies;
    std::vector<BodyLoad> loads;
};

After run(Device& device, const std::string& method, bool periodic) {
    FluidParams p;
    p.method = method;
    p.spacing = 0.03F;
    p.soundSpeed = 20;
    p.dfsph.maxIterations = 3;  // on every device
    p.dfsph.tolerance = 1.0e-6F;
    p.pbf.reach = p.dfsph.reach = 1;
    p.box.max = vec3(0.6F);
    p.box.periodicX = periodic;
    p.blocks = {{vec3(0), vec3(0.6F, 0.24F, 0.6F), vec3(0.4F, -0.3F, 0.2F)}};
    Solids solids;
    solids.bodies.resize(3);
    solids.bodies[0].shape = boxShape(vec3(0.15F, 0.1F, 0.2F), 500, p.spacing);
    solids.bodies[0].shape.sticks = 1;
    solids.bodies[0].state = {{vec3(0.02F, 0.22F, 0.3F), glm::angleAxis(0.4F, vec3(0, 0.6F, 0.8F))}, vec3(0, -1, 0), vec3(1, 2, -3)};
    solids.bodies[1].shape = sphereShape(0.08F, 200, p.spacing);
    solids.bodies[1].state = {{vec3(0.42F, 0.26F, 0.25F), quat(1, 0, 0, 0)}, vec3(-0.5F, -1, 0), vec3(0)};
    solids.bodies[2].shape = boxShape(vec3(0.12F), 0, p.spacing);
    solids.bodies[2].state.pose.position = vec3(0.4F, 0.1F, 0.5F);
    auto world = FluidWorld::create(device, p, solids, {});
    EXPECT_TRUE(world) << (world ? "" : world.error().message);
    After after;
    if (!world) return after;
    // A method without sound pushes only after the fluid has been compressed, which takes some frames.
    const int steps = method == "wcsph" ? 1 : method == "pbf" ? 2 : 3;
    for (int k = 0; k < steps; ++k) {
        (*world)->step({.gravity = p.gravity}, 2.0e-3);
        device.finish();
        device.poll();
    }
    const ParticleView view = (*world)->particles();
    const std::vector<vec4> x = device.readAll<vec4>(*view.position, view.slots), v = device.readAll<vec4>(*view.velocity, view.slots);
    const std::vector<uint32_t> id = device.readAll<uint32_t>(*view.id, view.slots);
    after.position.resize(view.slots);
    after.velocity.resize(view.slots);
    for (size_t i = 0; i < id.size(); ++i) {
        after.position[id[i]] = x[i];
        after.velocity[id[i]] = v[i];
    }
    after.bodies = (*world)->bodies();
    after.loads = (*world)->bodyLoads();
    return after;
}

double difference(const std::vector<vec4>& a, const std::vector<vec4>& b) {
    double worst = 0, largest = 0;
    for (size_t i = 0; i < a.size(); ++i)
        for (int k = 0; k < 4; ++k) {
            worst = std::max(worst, std::abs(double{a[i][k]} - double{b[i][k]}));
            largest = std::max(largest, std::abs(double{b[i][k]}));
        }
    return worst / largest;
}

struct Case {
    const char *device, *method;
    bool periodic;
};
class BodiesParity : public testing::TestWithParam<Case> {};

TEST_P(BodiesParity, AStepLeavesParticlesAndBodiesWhereTheCpuDoes) {
    Result<TestGpu> gpu = makeTestGpu(GetParam().device);
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    auto cpu = makeTestCpu();
    const After expected = run(*cpu, GetParam().method, GetParam().periodic),
                got = run(*gpu->device, GetParam().method, GetParam().periodic);
    ASSERT_EQ(got.position.size(), expected.position.size());
    ASSERT_GT(expected.position.size(), 3000U);
    EXPECT_LT(difference(got.position, expected.position), 1e-4);
    EXPECT_LT(difference(got.velocity, expected.velocity), 1e-4);
    // PBF's forces are differences of positions over dt^2; the tolerance is the rounding of a position (3e-8 m) of one particle (0.027 kg).
    const double rounding = std::string_view(GetParam().method) == "pbf" ? 3.0e-8 * 0.027 / (2.0e-3 * 2.0e-3) : 0.0;
    double largest = 0;
    for (const BodyLoad& load : expected.loads) largest = std::max(largest, glm::length(load.force));
    EXPECT_GT(largest, 0.1) << "the fluid exerts a force";
    for (size_t k = 0; k < expected.bodies.size(); ++k) {
        const BodyState &a = got.bodies[k], &b = expected.bodies[k];
        EXPECT_LT(glm::length(a.pose.position - b.pose.position), 1e-5F);
        EXPECT_LT(glm::length(a.velocity - b.velocity), 1e-4F * (1 + glm::length(b.velocity)));
        EXPECT_LT(glm::length(a.spin - b.spin), 1e-4F * (1 + glm::length(b.spin)));
        EXPECT_LT(glm::length(got.loads[k].force - expected.loads[k].force), 1e-4 * (largest + 1) + rounding);
    }
}

INSTANTIATE_TEST_SUITE_P(Devices, BodiesParity,
                         testing::Values(Case{"cl", "wcsph", false}, Case{"cl", "wcsph", true}, Case{"cl", "pbf", false},
                                         Case{"cl", "dfsph", false}, Case{"gl", "pbf", false}, Case{"gl", "dfsph", false},
                                         Case{"gl", "wcsph", false}, Case{"gl", "wcsph", true}),
                         [](const testing::TestParamInfo<Case>& row) {
                             return std::string(row.param.device) + "_" + row.param.method + (row.param.periodic ? "_periodic" : "");
                         });

}  // namespace
}  // namespace rivulet::bodies_parity_test
