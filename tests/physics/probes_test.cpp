// Loads that probes measure: Newton's third law for the fluid as a whole, and hydrostatics.
#include <gtest/gtest.h>
#include <json/json.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "fluid/session/run_stats.h"
#include "fluid/session/session.h"
#include "fluid/sim/solids/body_shapes.h"
#include "fluid/voxel/deforming_field.h"
#include "tests/physics/baked_mesh.h"
#include "tests/physics/loads.h"
#include "tests/physics/worlds.h"

namespace rivulet::probes_test {
namespace {

using test::Balance;

// A column of 8 by 12 by 8 spacings in the corner of a box.
FluidParams dam(const std::string& method) {
    FluidParams p;
    p.method = method;
    p.spacing = 0.025F;
    p.box.max = vec3(0.6F, 0.6F, 0.2F);
    p.blocks = {{vec3(0.0F), vec3(0.2F, 0.3F, 0.2F)}};
    return p;
}

Balance run(FluidParams p, const Solids& solids, const char* what, int frames = 45, const std::function<FluidInputs(int)>& inputs = {}) {
    p.probes = test::probesOfAll(solids);
    auto device = cpu();
    auto world = makeWorld(*device, p, solids);
    if (!world) return {.missing = 1.0e9};
    Balance b = test::balanceOf(*world, frames, inputs);
    std::printf("%s %s: missing %.2e of %.3f kg m/s, %u limited", p.method.c_str(), what, b.missing, b.scale, b.limited);
    for (size_t k = 0; k < b.impulses.size(); ++k)
        std::printf("; %s %.3f %.3f %.3f", p.probes[k].name.c_str(), b.impulses[k].x, b.impulses[k].y, b.impulses[k].z);
    std::printf("\n");
    EXPECT_EQ(world->stats().lost, 0U);
    return b;
}

class Loads : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Methods, Loads, testing::Values("dfsph", "pbf", "wcsph"), [](const auto& row) { return std::string(row.param); });

constexpr double kMissing = 1.0e-4;

TEST_P(Loads, OfABoxAreTheChangeOfMomentum) {
    FluidParams p = dam(GetParam());
    p.collision.friction = 0.2F;
    p.box.restitution = 0.3F;
    EXPECT_LT(run(p, {}, "dam break").missing, kMissing);
}

TEST_P(Loads, OfAPoolAtRestAreTheChangeOfMomentum) {
    FluidParams p = dam(GetParam());
    p.blocks = {{vec3(0.0F), vec3(0.6F, 0.1F, 0.2F)}};
    EXPECT_LT(run(p, {}, "pool").missing, kMissing);
}

TEST_P(Loads, OfPlanesAreTheChangeOfMomentum) {
    const Solids solids{.planes = {{vec3(0.4F, 0.0F, 0.0F), vec3(-1.0F, 1.0F, 0.0F)}, {vec3(0.0F, 0.02F, 0.1F), vec3(0.05F, 1.0F, 0.1F)}}};
    FluidParams p = dam(GetParam());
    p.collision.friction = 0.1F;
    p.blocks[0].min.y = 0.05F;
    const Balance b = run(p, solids, "planes");
    EXPECT_LT(b.missing, kMissing);
    EXPECT_GT(b.impulses[1].x, 0.02 * b.scale) << "the slope stops the flow along +x";
}

TEST_P(Loads, OfAMeshAreTheChangeOfMomentum) {
    const float s = 0.025F;
    const VoxelField step = test::baked(test::makeBox(vec3(0.4F, -0.1F, 0.05F), vec3(0.5F, 0.15F, 0.15F)), 0.25F * s, s);
    FluidParams p = dam(GetParam());
    p.collision.friction = 0.1F;
    const Balance b = run(p, {.field = &step}, "obstacle");
    EXPECT_LT(b.missing, kMissing);
    EXPECT_GT(b.impulses[1].x, 0.02 * b.scale) << "the flow pushes the obstacle along +x";
}

// A tank of a mesh alone: the box is far away.
TEST_P(Loads, OfAMeshTankAreTheChangeOfMomentum) {
    const float s = 0.025F;
    const vec3 a(0.0F), top(0.6F, 0.8F, 0.2F);  // drops fly more than twice as high as the column
    test::Mesh walls;                           // open at the top
    walls.quad(a, vec3(top.x, 0, 0), vec3(top.x, 0, top.z), vec3(0, 0, top.z));
    walls.quad(a, vec3(0, 0, top.z), vec3(0, top.y, top.z), vec3(0, top.y, 0));
    walls.quad(vec3(top.x, 0, 0), vec3(top.x, 0, top.z), top, vec3(top.x, top.y, 0));
    walls.quad(a, vec3(top.x, 0, 0), vec3(top.x, top.y, 0), vec3(0, top.y, 0));
    walls.quad(vec3(0, 0, top.z), vec3(top.x, 0, top.z), top, vec3(0, top.y, top.z));
    const VoxelField tank = test::baked(walls, 0.2F * s, s);
    FluidParams p = dam(GetParam());
    p.box.min = vec3(-0.3F);
    p.box.max = vec3(0.9F, 1.1F, 0.5F);
    p.blocks = {{vec3(0.025F), vec3(0.225F, 0.3F, 0.175F)}};
    const Balance b = run(p, {.field = &tank}, "mesh tank");
    EXPECT_LT(b.missing, kMissing);
    ASSERT_EQ(b.impulses.size(), 2U);
    EXPECT_EQ(b.impulses[0], dvec3(0.0)) << "nothing reaches the box";
}

TEST_P(Loads, OfAMovingSolidAreTheChangeOfMomentum) {
    const float s = 0.025F;
    const VoxelField paddle = test::baked(test::makeBox(vec3(-0.03F, -0.2F, -0.3F), vec3(0.03F, 0.2F, 0.3F)), 0.25F * s, s);
    FluidParams p = dam(GetParam());
    p.blocks = {{vec3(0.0F), vec3(0.4F, 0.1F, 0.2F)}};
    p.collision.friction = 0.1F;
    Pose pose{vec3(0.5F, 0.25F, 0.1F), quat(1, 0, 0, 0)};
    const Solids solids{.rigid = {{&paddle, pose}}};
    const Balance b = run(p, solids, "paddle", 45, [&](int k) {
        const float angle = 0.8F * std::sin(0.15F * static_cast<float>(k + 1));
        pose.position.x = 0.5F - 0.2F * std::sin(0.1F * static_cast<float>(k + 1));
        pose.rotation = glm::angleAxis(angle, vec3(0, 0, 1));
        return FluidInputs{.poses = std::span(&pose, 1)};
    });
    EXPECT_LT(b.missing, kMissing);
    EXPECT_GT(glm::length(b.impulses[1]), 0.02 * b.scale);
}

TEST_P(Loads, OfAMeshThatBendsAreTheChangeOfMomentum) {
    const float s = 0.025F;
    const test::Mesh plate = test::makeBox(vec3(0.3F, -0.1F, -0.1F), vec3(0.4F, 0.4F, 0.3F));
    const MeshView view = plate.view();
    Bounds reach;
    reach.add(vec3(0.05F, -0.15F, -0.15F));
    reach.add(vec3(0.6F, 0.5F, 0.35F));
    Result<DeformingField> field = DeformingField::create(std::span(&view, 1), reach, {.resolution = 90, .band = 2 * s, .padding = 2 * s});
    ASSERT_TRUE(field) << field.error().message;
    for (const char* walls : {"slip", "no-slip"}) {
        FluidParams p = dam(GetParam());
        p.collision.walls = walls;
        p.viscosity = 2.0e-3F;
        p.blocks = {{vec3(0.0F), vec3(0.25F, 0.2F, 0.2F)}};
        std::vector<vec3> shape;
        std::span<const vec3> of;
        const Balance b = run(p, {.deforming = {&*field}}, "bending plate", 40, [&](int k) {
            shape = plate.positions;
            for (vec3& x : shape) x.x += 0.25F * x.y * std::sin(0.2F * static_cast<float>(k + 1));
            of = shape;
            return FluidInputs{.shapes = std::span(&of, 1)};
        });
        EXPECT_LT(b.missing, kMissing) << walls;
        EXPECT_GT(glm::length(b.impulses[1]), 0.02 * b.scale) << walls;
    }
}

TEST_P(Loads, OfABodyAreTheChangeOfMomentum) {
    const float s = 0.025F;
    FluidParams p = dam(GetParam());
    p.blocks = {{vec3(0.0F), vec3(0.6F, 0.15F, 0.2F)}};
    Body body;
    body.shape = sphereShape(2.5F * s, 400, s);
    body.state.pose.position = vec3(0.3F, 0.25F, 0.1F);
    const Balance b = run(p, {.bodies = {body}}, "floating ball", 60);
    EXPECT_LT(b.missing, kMissing);
    EXPECT_GT(b.impulses[1].y, 0.005 * b.scale) << "the water lifts it";
}

TEST_P(Loads, OfNoSlipAndStickingWallsAreTheChangeOfMomentum) {
    const float s = 0.025F;
    const VoxelField step = test::baked(test::makeBox(vec3(0.4F, -0.1F, 0.05F), vec3(0.5F, 0.15F, 0.15F)), 0.25F * s, s);
    const VoxelField paddle = test::baked(test::makeBox(vec3(-0.03F, -0.2F, -0.3F), vec3(0.03F, 0.2F, 0.3F)), 0.25F * s, s);
    for (const char* way : {"explicit", "implicit"}) {
        FluidParams p = dam(GetParam());
        p.collision.walls = "no-slip";
        p.viscosity = 2.0e-3F;
        p.forces.viscosity = way;
        p.forces.adhesion = 0.5F;
        p.forces.tension = 0.1F;
        Pose pose{vec3(0.35F, 0.3F, 0.1F), quat(1, 0, 0, 0)};
        const Balance b = run(p, {.field = &step, .rigid = {{&paddle, pose}}}, way, 25, [&](int) {
            pose.position.y -= 0.002F;
            return FluidInputs{.poses = std::span(&pose, 1)};
        });
        EXPECT_LT(b.missing, kMissing) << way;
    }
}

// Two liquids: particles differ in mass.
TEST_P(Loads, OfTwoLiquidsAreTheirWeight) {
    FluidParams p = dam(GetParam());
    p.liquid = "water";
    p.blocks = {{vec3(0.0F), vec3(0.6F, 0.1F, 0.2F)}, {vec3(0.0F, 0.1F, 0.0F), vec3(0.6F, 0.2F, 0.2F)}};
    p.blocks[1].liquid = "oil";
    p.probes = {{.name = "floor", .face = "-y"}};
    auto device = cpu();
    auto world = makeWorld(*device, p);
    ASSERT_TRUE(world);
    for (int k = 0; k < 60; ++k) world->step({}, 1.0 / 60);
    const double before = world->stats().loads.probes[0].impulse.y, from = world->time();
    for (int k = 0; k < 60; ++k) world->step({}, 1.0 / 60);
    const double force = (world->stats().loads.probes[0].impulse.y - before) / (world->time() - from);
    double mass = 0;
    const FluidStats& stats = world->stats();
    mass = -stats.potential / (double{p.gravity.y} * stats.centreOfMass[1]);
    EXPECT_NEAR(force / (mass * double{p.gravity.y}), 1.0, 0.01);
}

// ---- Hydrostatics, at default settings ----

TEST_P(Loads, OfAPoolAreHydrostatic) {
    FluidParams p;
    p.method = GetParam();
    p.spacing = 0.02F;
    const float depth = 0.2F, width = 0.3F;
    p.box.max = vec3(0.4F, 0.4F, width);
    p.blocks = {{vec3(0.0F), vec3(0.4F, depth, width)}};
    p.probes = {{.name = "floor", .face = "-y", .about = vec3(0.0F)},
                {.name = "wall", .face = "+x", .max = vec3(1.0e5F, depth, 1.0e5F), .about = vec3(0.4F, 0.0F, 0.15F)},
                {.name = "low part", .face = "+x", .min = vec3(0.4F, 0.0F, 0.1F), .max = vec3(0.4F, 0.1F, 0.2F)},
                {.name = "half of the floor", .face = "-y", .min = vec3(0.0F), .max = vec3(0.2F, 0.0F, width)}};
    auto device = cpu();
    auto world = makeWorld(*device, p);
    ASSERT_TRUE(world);
    constexpr int kSettle = 120, kFrames = 120;
    for (int k = 0; k < kSettle; ++k) world->step({}, 1.0 / 60);
    world->takeLoads();
    dvec3 floor(0.0), floorTorque(0.0), wall(0.0), wallTorque(0.0);
    double pressure = 0, low = 0, half = 0;
    for (int k = 0; k < kFrames; ++k) {
        world->step({}, 1.0 / 60);
        const std::vector<ProbeFrame> frames = world->takeLoads();
        ASSERT_EQ(frames.size(), 1U);
        const std::vector<ProbeReading>& r = frames[0].probes;
        floor += r[0].force / double{kFrames};
        floorTorque += r[0].torque / double{kFrames};
        wall += r[1].force / double{kFrames};
        wallTorque += r[1].torque / double{kFrames};
        pressure += *r[1].pressure / kFrames;
        low += *r[2].pressure / kFrames;
        half += r[3].force.y / kFrames;
    }
    const double g = 9.81, rho = 1000, h = double{depth}, weight = rho * g * 0.4 * h * double{width};
    std::printf(
        "%s: floor %.4f of the weight, wall %.4f of rho g H / 2, its lower part %.4f of rho g 3/4 H, half the floor %.4f, height of "
        "the wall's force %.4f of H / 3\n",
        GetParam(), -floor.y / weight, pressure / (0.5 * rho * g * h), low / (0.75 * rho * g * h), -half / (0.5 * weight),
        -wallTorque.z / wall.x / (h / 3));
    EXPECT_NEAR(-floor.y / weight, 1.0, 0.01);
    EXPECT_NEAR(pressure / (0.5 * rho * g * h), 1.0, 0.05);
    EXPECT_NEAR(wall.x, pressure * h * double{width}, 1.0e-3 * wall.x) << "the pressure is the force over the area";
    EXPECT_NEAR(-half / (0.5 * weight), 1.0, 0.02);
    EXPECT_NEAR(floorTorque.z / (0.2 * floor.y), 1.0, 0.02) << "the weight acts in the middle";
    EXPECT_NEAR(low / (0.75 * rho * g * h), 1.0, 0.06);
    EXPECT_NEAR(-wallTorque.z / wall.x / (h / 3), 1.0, 0.1);
}

// ---- Scenes ----

// Each collider of a scene has its own load, whatever it is made of, and --stats holds a series of each.
TEST(Probes, OfAScenesCollidersAreInItsStatistics) {
    SceneFile scene;
    scene.fluid.method = "dfsph";
    scene.fluid.spacing = 0.025F;
    scene.fluid.box.max = vec3(0.6F, 0.6F, 0.2F);
    scene.fluid.blocks = {{vec3(0.0F), vec3(0.2F, 0.3F, 0.2F)}};
    ColliderParams ball;
    ball.mesh = "meshes/sphere.obj";
    ball.fitSize = 0.1F;
    ball.position = vec3(0.3F, 0.05F, 0.1F);
    scene.colliders.push_back(ball);
    ColliderParams wall;
    wall.shape = "plane";
    wall.position = vec3(0.55F, 0.0F, 0.0F);
    wall.normal = vec3(-1.0F, 0.0F, 0.0F);
    scene.colliders.push_back(wall);
    ball.position = vec3(0.45F, 0.05F, 0.1F);
    scene.colliders.push_back(ball);
    ball.position = vec3(0.1F, 0.53F, 0.1F);  // nothing reaches it
    ball.motion.spin = 90;
    scene.colliders.push_back(ball);
    for (const int index : {0, 1, 2, 3}) scene.fluid.probes.push_back({.name = std::to_string(index), .on = "collider", .index = index});
    scene.fluid.probes.push_back({.name = "box"});
    auto device = cpu();
    auto session = Session::create(scene, *device, {});
    ASSERT_TRUE(session) << session.error().message;
    FluidWorld& world = (*session)->world();
    double mass = 0;
    const dvec3 start = test::momentumOf(world, &mass);
    RunRecorder recorder(world, (*session)->fields(), false);
    constexpr int kFrames = 30;
    for (int k = 0; k < kFrames; ++k) recorder.stepped((*session)->step(1.0 / 60, true), {});
    const std::string text = writeRunStats(recorder.finish("probes"));
    Json::Value stats;
    ASSERT_TRUE(Json::Reader().parse(text, stats));
    dvec3 impulses(0.0);
    for (const ProbeParams& p : scene.fluid.probes) {
        const Json::Value& series = stats["probes"][p.name];
        ASSERT_EQ(series["time"].size(), static_cast<unsigned>(kFrames)) << text;
        ASSERT_EQ(series["force"].size(), static_cast<unsigned>(kFrames));
        dvec3 sum(0.0);
        for (unsigned k = 0; k < static_cast<unsigned>(kFrames); ++k)
            for (int axis = 0; axis < 3; ++axis) sum[axis] += series["force"][k][axis].asDouble() * series["seconds"][k].asDouble();
        for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(sum[axis], series["impulse"][axis].asDouble(), 1.0e-5);
        impulses += sum;
        EXPECT_EQ(series.isMember("pressure"), false);
    }
    const dvec3 missing = test::momentumOf(world) - start - dvec3(scene.fluid.gravity) * mass * world.time() + impulses;
    EXPECT_LT(glm::length(missing), 1.0e-3 * mass * 9.81 * world.time());
    const auto along = [&](const char* name) { return stats["probes"][name]["impulse"][0].asDouble(); };
    EXPECT_GT(along("0"), 3 * along("2")) << "the first ball shelters the second";
    // The wave pushes the second ball forward, and then flows back from the plane behind it.
    double first = 0;
    for (const Json::Value& force : stats["probes"]["2"]["force"])
        if (first == 0 && std::abs(force[0].asDouble()) > 0.5) first = force[0].asDouble();
    EXPECT_GT(first, 0.5);
    EXPECT_GT(along("1"), 0.01);
    EXPECT_EQ(along("3"), 0);
}

// A world without probes has the same bits as one with them.
TEST_P(Loads, MeasuringChangesNothing) {
    std::vector<vec4> last;
    for (const bool measured : {false, true}) {
        FluidParams p = dam(GetParam());
        if (measured) p.probes = {{.name = "box"}};
        auto device = cpu();
        auto world = makeWorld(*device, p);
        ASSERT_TRUE(world);
        for (int k = 0; k < 20; ++k) world->step({}, 1.0 / 60);
        const std::vector<vec4> now = device->readAll<vec4>(*world->particles().position, world->particles().count);
        if (measured) EXPECT_TRUE(std::equal(now.begin(), now.end(), last.begin(), last.end()));
        last = now;
    }
}

TEST(Probes, ChangeWhileTheWorldRuns) {
    FluidParams p = dam("dfsph");
    auto device = cpu();
    auto world = makeWorld(*device, p);
    ASSERT_TRUE(world);
    world->step({}, 1.0 / 60);
    EXPECT_TRUE(world->stats().loads.probes.empty());
    p.probes = {{.name = "floor", .face = "-y"}};
    ASSERT_TRUE(world->setParams(p));
    world->step({}, 1.0 / 60);
    ASSERT_EQ(world->stats().loads.probes.size(), 1U);
    const double first = world->stats().loads.probes[0].impulse.y;
    EXPECT_LT(first, 0);
    FluidParams wrong = p;
    wrong.probes[0].on = "body";
    EXPECT_FALSE(world->setParams(wrong));
    WorldState state;
    world->save(state);
    world->step({}, 1.0 / 60);
    const ProbeReading second = world->stats().loads.probes[0];
    EXPECT_EQ(world->takeLoads().size(), 2U);
    ASSERT_TRUE(world->restore(state));
    EXPECT_TRUE(world->stats().loads.probes.empty());
    world->step({}, 1.0 / 60);
    EXPECT_EQ(world->stats().loads.probes[0].force, second.force) << "the same step again";
    EXPECT_NEAR(world->stats().loads.probes[0].impulse.y, second.impulse.y - first, 1.0e-9) << "sums begin again";
    p.probes.clear();
    ASSERT_TRUE(world->setParams(p));
    world->step({}, 1.0 / 60);
    EXPECT_TRUE(world->stats().loads.probes.empty());
}

TEST(Probes, WrongOnesAreRefusedWithARemedy) {
    auto device = cpu();
    const auto why = [&](std::vector<ProbeParams> probes, const Solids& solids = {}) {
        FluidParams p = dam("pbf");
        p.probes = std::move(probes);
        auto world = FluidWorld::create(*device, p, solids, {});
        return world ? std::string("accepted") : world.error().message;
    };
    EXPECT_EQ(why({{.name = "a"}, {.name = "a"}}), "fluid.probes[1].name is a, as of another probe: give each its own");
    EXPECT_EQ(why({{}}), "fluid.probes[0].name is empty: give the probe a name");
    EXPECT_EQ(why({{.name = "a", .on = "body"}}), "fluid.probes[0].on is body, and there is none: add one, or remove the probe");
    EXPECT_EQ(why({{.name = "a", .on = "collider", .index = 0}}),
              "fluid.probes[0].index is 0, and there are 0 colliders: give the number of one of them, from 0");
    EXPECT_EQ(why({{.name = "a", .on = "collider", .index = 0}}, {.colliders = {{}}}),
              "fluid.probes[0]: collider 0 is not solid: it bears no load");
    EXPECT_EQ(why({{.name = "a", .min = vec3(1.0F), .max = vec3(0.0F)}}), "fluid.probes[0].min is above its max along x: exchange them");
    EXPECT_EQ(why({{.name = "a", .face = "+x", .max = vec3(0.1F)}}),
              "fluid.probes[0]: the region does not reach the face +x of fluid.box: correct min and max");
    EXPECT_EQ(why({{.name = "a", .on = "plane", .index = 0}}, {.planes = {{}}, .colliders = {{ProbeOn::plane, 0}}}), "accepted");
}

}  // namespace
}  // namespace rivulet::probes_test
