// Water that hangs from a ceiling (fluid.dfsph.negativePressure), alone, with a second liquid and with a body: cl and gl leave it where the
// cpu does.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "fluid/sim/solids/body_shapes.h"
#include "fluid/sim/world/host_particles.h"
#include "tests/parity/devices.h"

namespace rivulet::negative_pressure_test {
namespace {

struct Row {
    const char* name;
    bool liquids, body;
};

struct After {
    std::vector<vec3> position, velocity;  // by id
    float lowest = 0;                      // Pa
};

After hang(Device& device, const Row& row, int steps) {
    FluidParams p;
    p.method = "dfsph";
    p.dfsph.negativePressure = true;
    p.dfsph.tolerance = 1.0e-6F;
    p.dfsph.maxIterations = 12;  // on every device
    p.spacing = 0.03F;
    p.box = {.min = vec3(0), .max = vec3(0.45F, 0.9F, 0.3F), .periodicZ = true};
    p.blocks = {{.min = vec3(0, 0.6F, 0), .max = vec3(0.45F, 0.9F, 0.3F)}};
    if (row.liquids) {
        p.blocks[0].max.y = 0.75F;
        p.blocks.push_back({.min = vec3(0, 0.75F, 0), .max = vec3(0.45F, 0.9F, 0.3F), .liquid = "oil"});
    }
    Solids solids;
    if (row.body) {
        solids.bodies.resize(1);
        solids.bodies[0].shape = sphereShape(0.06F, 500, p.spacing);
        solids.bodies[0].state.pose.position = vec3(0.2F, 0.74F, 0.15F);
    }
    auto world = FluidWorld::create(device, p, solids, {});
    EXPECT_TRUE(world) << (world ? "" : world.error().message);
    After after;
    if (!world) return after;
    for (int k = 0; k < steps; ++k) (*world)->step({.gravity = p.gravity}, 1.0 / 480);
    const HostParticles all = readParticles(**world);
    after.position.resize(all.position.size());
    after.velocity.resize(all.position.size());
    for (size_t k = 0; k < all.position.size(); ++k) {
        after.position.at(all.id[k]) = vec3(all.position[k]);
        after.velocity.at(all.id[k]) = vec3(all.velocity[k]);
    }
    for (const float pascal : (*world)->pressures()) after.lowest = std::min(after.lowest, pascal);
    return after;
}

class NegativePressure : public testing::TestWithParam<std::tuple<const char*, Row>> {};

TEST_P(NegativePressure, HoldsWaterWhereTheCpuDoes) {
    const auto& [name, row] = GetParam();
    Result<TestGpu> gpu = makeTestGpu(name);
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    auto cpu = makeTestCpu();
    // All kernels take part in the first step; later ones multiply rounding, because a particle at the surface falls on either side of a
    // limit.
    const After here = hang(*cpu, row, 1), there = hang(*gpu->device, row, 1);
    EXPECT_LT(here.lowest, -200) << "Pa: there is tension";
    EXPECT_NEAR(there.lowest / here.lowest, 1, 1.0e-4);
    ASSERT_EQ(there.position.size(), here.position.size());
    double moved = 0, slower = 0;
    for (size_t k = 0; k < here.position.size(); ++k) {
        moved = std::max(moved, static_cast<double>(glm::distance(there.position[k], here.position[k])));
        slower = std::max(slower, static_cast<double>(glm::distance(there.velocity[k], here.velocity[k])));
    }
    EXPECT_LT(moved, 3.0e-6) << "m, a ten-thousandth of a spacing";
    EXPECT_LT(slower, 1.0e-4) << "m/s";
    RecordProperty("moved", std::to_string(moved));
    RecordProperty("slower", std::to_string(slower));

    const After later = hang(*cpu, row, 12), laterThere = hang(*gpu->device, row, 12);
    const auto height = [](const After& a) {
        return std::accumulate(a.position.begin(), a.position.end(), 0.0, [](double sum, const vec3& x) { return sum + double{x.y}; }) /
               static_cast<double>(a.position.size());
    };
    EXPECT_NEAR(height(laterThere), height(later), 3.0e-5) << "m: free fall would lower it by 3 mm";
}

INSTANTIATE_TEST_SUITE_P(Devices, NegativePressure,
                         testing::Combine(testing::Values("cl", "gl"),
                                          testing::Values(Row{"water", false, false}, Row{"liquids", true, false},
                                                          Row{"body", false, true})),
                         [](const auto& of) { return std::string(std::get<0>(of.param)) + "_" + std::get<1>(of.param).name; });

}  // namespace
}  // namespace rivulet::negative_pressure_test
