// A small world with a wall of every kind: gl and cl agree with the cpu, and no particle is in a solid.
#include <gtest/gtest.h>

#include "fluid/session/run_stats.h"
#include "fluid/sim/world/fluid_world.h"
#include "tests/parity/devices.h"
#include "tests/unit/voxel_test_meshes.h"

namespace rivulet::solids_parity_test {
namespace {

constexpr float kSpacing = 0.05F;

struct Outcome {
    dvec3 centre{0.0};
    double kinetic = 0;
    size_t inSolid = 0, lost = 0;
};

VoxelFieldOptions options(float side) {
    return {.resolution = static_cast<int>(side / (0.25F * kSpacing)), .band = 2 * kSpacing, .padding = 2 * kSpacing};
}

// A fixed ball, a rotating blade, a deforming sheet below and a plane; water falls among them for 0.25 s.
Outcome run(Device& device, const std::string& walk, const char* walls) {
    Outcome out;
    const test::Mesh ball = test::makeSphere(vec3(0.3F, 0.35F, 0.3F), 0.12F, 16);
    test::Mesh blade;
    blade.quad(vec3(-0.2F, 0, -0.2F), vec3(0.2F, 0, -0.2F), vec3(0.2F, 0, 0.2F), vec3(-0.2F, 0, 0.2F));
    test::Mesh sheet;
    for (int z = 0; z <= 6; ++z)
        for (int x = 0; x <= 10; ++x)
            sheet.positions.emplace_back(-0.1F + 0.12F * static_cast<float>(x), 0.15F, -0.1F + 0.14F * static_cast<float>(z));
    for (uint32_t z = 0; z < 6; ++z)
        for (uint32_t x = 0; x < 10; ++x) {
            const uint32_t a = z * 11 + x;
            for (uint32_t i : {a, a + 12, a + 1, a, a + 11, a + 12}) sheet.indices.push_back(i);
        }
    const MeshView ballView = ball.view(), bladeView = blade.view(), sheetView = sheet.view();
    auto still = bakeVoxelField(std::span(&ballView, 1), options(0.24F)), turning = bakeVoxelField(std::span(&bladeView, 1), options(0.4F));
    Bounds reach;
    for (const vec3& p : sheet.positions) reach.add(p);
    reach.min.y -= 0.05F;
    reach.max.y += 0.05F;
    auto bending = DeformingField::create(std::span(&sheetView, 1), reach, options(1.2F));
    EXPECT_TRUE(still && turning && bending);
    if (!still || !turning || !bending) return out;

    FluidParams p{.method = "wcsph"};
    p.spacing = kSpacing;
    p.soundSpeed = 15;
    p.cfl = 0.8F;
    p.box.max = vec3(1, 0.9F, 0.6F);
    p.blocks = {{vec3(0.05F, 0.5F, 0.05F), vec3(0.95F, 0.75F, 0.55F), vec3(0.0F)}};
    p.collision.walk = walk;
    p.collision.walls = walls;
    p.viscosity = 5.0e-3F;
    Pose pose{vec3(0.7F, 0.35F, 0.3F), quat(1, 0, 0, 0)};
    Solids solids{.field = &*still,
                  .planes = {{vec3(0, 0.05F, 0), vec3(0.1F, 1, 0), 1}},
                  .rigid = {{&*turning, pose}},
                  .deforming = {&*bending},
                  .surfaces = {{0.1F, 0.2F}, {0.3F, 0.0F}}};
    auto world = FluidWorld::create(device, p, solids, {});
    EXPECT_TRUE(world) << (world ? "" : world.error().message);
    if (!world) return out;
    constexpr int kFrames = 15;
    for (int k = 1; k <= kFrames; ++k) {
        const float t = static_cast<float>(k) / 60;
        pose.rotation = glm::angleAxis(4 * t, vec3(0, 0, 1));
        std::vector<vec3> shape = sheet.positions;
        for (vec3& v : shape) v.y += 0.04F * std::sin(8 * t) * std::cos(6 * v.x);
        const std::span<const vec3> vertices(shape);
        (*world)->step({.gravity = p.gravity, .poses = std::span(&pose, 1), .shapes = std::span(&vertices, 1)}, 1.0 / 60);
        for (const vec4& x : device.readAll<vec4>(*(*world)->particles().position, (*world)->particles().count)) {
            const vec4 own((*world)->poses()[0].toOwn(vec3(x)), 1);
            out.inSolid +=
                inSetVoxel(still->surface, x) || inSetVoxel(turning->surface, own) || inSetVoxel(bending->field().surface, x) ? 1 : 0;
        }
    }
    const HostParticles now = readParticles(**world);
    for (size_t i = 0; i < now.position.size(); ++i) {
        if (!isFinite(vec3(now.position[i]))) ++out.lost;
        out.centre += dvec3(vec3(now.position[i])) / static_cast<double>(now.position.size());
        out.kinetic += static_cast<double>(glm::dot(vec3(now.velocity[i]), vec3(now.velocity[i])));
    }
    return out;
}

class SolidsParity : public ::testing::TestWithParam<const char*> {};

TEST_P(SolidsParity, TheSameWaterAmongSolidsOfEveryKind) {
    Result<TestGpu> gpu = makeTestGpu(GetParam());
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    const std::unique_ptr<Device> cpu = makeTestCpu();
    for (const auto& [walk, walls] : {std::pair("exact", "slip"), std::pair("thesis", "slip"), std::pair("exact", "no-slip")}) {
        const Outcome here = run(*cpu, walk, walls), there = run(*gpu->device, walk, walls);
        for (const Outcome* o : {&here, &there}) {
            EXPECT_EQ(o->lost, 0U) << walk << ", " << walls;
            if (std::string(walk) == "exact") EXPECT_EQ(o->inSolid, 0U);
        }
        EXPECT_LT(glm::length(here.centre - there.centre), 0.005) << walk << ", " << walls;
        EXPECT_NEAR(here.kinetic, there.kinetic, 0.05 * here.kinetic) << walk << ", " << walls;
    }
}

INSTANTIATE_TEST_SUITE_P(Devices, SolidsParity, ::testing::Values("cl", "gl"), [](const auto& p) { return std::string(p.param); });

}  // namespace
}  // namespace rivulet::solids_parity_test
