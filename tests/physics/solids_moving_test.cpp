// Moving and deforming solids: no particle passes them at any speed, and they carry, push and pour water.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/compute/device_cpu.h"
#include "engine/scene/import_model.h"
#include "engine/scene/transform.h"
#include "fluid/session/run_stats.h"
#include "fluid/session/session.h"
#include "fluid/sim/world/cpu_kernels.h"
#include "fluid/sim/world/fluid_world.h"
#include "tests/physics/baked_mesh.h"

namespace rivulet::solids_moving_test {
namespace {

std::unique_ptr<CpuDevice> cpu() {
    static const std::vector<CpuKernelRow> rows = cpuKernels();
    return makeCpuDevice(rows);
}

FluidParams fluid(const vec3& low, const vec3& high, float spacing, const vec3& blockLow, const vec3& blockHigh) {
    FluidParams p{.method = "wcsph"};
    p.spacing = spacing;
    p.soundSpeed = 20;
    p.cfl = 0.8F;
    p.box.min = low;
    p.box.max = high;
    p.blocks = {{blockLow, blockHigh, vec3(0.0F)}};
    return p;
}

std::vector<vec3> places(FluidWorld& world) {
    std::vector<vec3> all;
    for (const vec4& p : world.device().readAll<vec4>(*world.particles().position, world.particles().count)) all.emplace_back(p);
    return all;
}

quat turned(float degrees, const vec3& axis) { return glm::angleAxis(degrees * kPi / 180, glm::normalize(axis)); }

// To a triangle: the foot on its plane if that is inside, else the nearest of the three edges.
double distanceTo(const dvec3& p, const dvec3& a, const dvec3& b, const dvec3& c) {
    const dvec3 n = glm::cross(b - a, c - a);
    const auto beside = [&](const dvec3& u, const dvec3& v) { return glm::dot(glm::cross(v - u, p - u), n) >= 0; };
    if (glm::dot(n, n) > 0 && beside(a, b) && beside(b, c) && beside(c, a)) return std::abs(glm::dot(p - a, n)) / glm::length(n);
    const auto edge = [&](const dvec3& u, const dvec3& v) {
        const double square = glm::dot(v - u, v - u);
        const double t = square > 0 ? std::clamp(glm::dot(p - u, v - u) / square, 0.0, 1.0) : 0.0;
        return glm::length(p - u - (v - u) * t);
    };
    return std::min(edge(a, b), std::min(edge(b, c), edge(c, a)));
}

// A sheet without thickness sweeps through a block of resting water at up to 60 m/s, tilted or not, with frames of 4 to 40 ms: all water is
// in front of it afterwards.
TEST(MovingSolid, AFastPlateLeavesNothingBehind) {
    for (const float speed : {0.5F, 5.0F, 60.0F})
        for (const float tilt : {0.0F, 31.0F}) {
            auto device = cpu();
            const float spacing = 0.04F;
            FluidParams p = fluid(vec3(-6, -0.5F, -0.5F), vec3(6, 0.5F, 0.5F), spacing, vec3(-0.2F), vec3(0.2F));
            p.gravity = vec3(0.0F);
            const VoxelField plate = test::baked(test::makeSheet(vec3(0), vec3(1, 0, 0), 1.6F), 0.25F * spacing, spacing);
            Pose pose{vec3(-0.6F, 0, 0), turned(tilt, vec3(0, 0.4F, 1))};
            auto world = FluidWorld::create(*device, p, {.rigid = {{&plate, pose}}}, {});
            ASSERT_TRUE(world) << world.error().message;
            const float way = 1.2F;
            const double frame = speed > 10 ? 0.02 : 0.04;
            const int frames = std::max(1, static_cast<int>(std::ceil(way / speed / frame)));
            for (int k = 1; k <= frames; ++k) {
                pose.position.x = -0.6F + way * static_cast<float>(k) / static_cast<float>(frames);
                (*world)->step({.gravity = p.gravity, .poses = std::span(&pose, 1)}, way / speed / frames);
            }
            EXPECT_EQ((*world)->stats().lost, 0U);
            const float contact = fieldParams(plate, {.spacing = spacing}).contact;
            size_t behind = 0, near = 0;
            for (const vec3& x : places(**world)) {
                const vec3 own = (*world)->poses()[0].toOwn(x);
                if (std::max(std::abs(own.y), std::abs(own.z)) > 0.8F) continue;  // squeezed out around the plate's edge
                behind += own.x < 0.9F * contact ? 1 : 0;
                near += own.x < 1.5F * contact ? 1 : 0;
            }
            EXPECT_EQ(behind, 0U) << speed << " m/s, tilted by " << tilt;
            EXPECT_GT(near, 10U) << "it carries a layer before it";
        }
}

// Friction uses the wall's velocity: a moving floor with full friction carries a particle along, a floor without friction does not.
TEST(MovingSolid, FrictionCarriesAlong) {
    for (const float friction : {0.0F, 5.0F}) {
        auto device = cpu();
        const float spacing = 0.04F;
        FluidParams p = fluid(vec3(-2, -0.5F, -1), vec3(2, 1, 1), spacing, vec3(0), vec3(spacing));  // one particle
        const VoxelField floor = test::baked(test::makeSheet(vec3(0), vec3(0, 1, 0), 1.0F), 0.25F * spacing, spacing);
        Pose pose{vec3(0, -0.03F, 0), {}};
        pose.rotation = quat(1, 0, 0, 0);
        auto world = FluidWorld::create(*device, p, {.rigid = {{&floor, pose}}, .surfaces = {{friction, 0.0F}}}, {});
        ASSERT_TRUE(world) << world.error().message;
        ASSERT_EQ((*world)->particles().count, 1U);
        for (int k = 0; k < 60; ++k) {
            if (k >= 20) pose.position.x += 0.3F / 60;
            (*world)->step({.gravity = p.gravity, .poses = std::span(&pose, 1)}, 1.0 / 60);
        }
        const vec3 x = places(**world)[0];
        const float contact = fieldParams(floor, {.spacing = spacing}).contact;
        EXPECT_NEAR(x.y, -0.03F + contact, 0.1F * contact);
        EXPECT_NEAR(x.x, 0.5F * spacing + (friction > 0 ? 0.2F : 0.0F), 0.01F) << "friction " << friction;
    }
}

// A full turn in a tenth of a second, in long frames: particles in the wheel's path are thrown, and the wheel does not pass them.
TEST(MovingSolid, ASpinningPlateSweepsItsWholeCircle) {
    auto device = cpu();
    const float spacing = 0.05F;
    FluidParams p = fluid(vec3(-3), vec3(3), spacing, vec3(0.1F, -0.5F, -0.2F), vec3(0.6F, -0.1F, 0.2F));
    p.gravity = vec3(0.0F);
    test::Mesh blade;
    blade.quad(vec3(0, 0, -0.5F), vec3(0.9F, 0, -0.5F), vec3(0.9F, 0, 0.5F), vec3(0, 0, 0.5F));
    const VoxelField field = test::baked(blade, 0.25F * spacing, spacing);
    Pose pose{vec3(0), quat(1, 0, 0, 0)};
    auto world = FluidWorld::create(*device, p, {.rigid = {{&field, pose}}}, {});
    ASSERT_TRUE(world) << world.error().message;
    float angle = 0;
    for (int k = 0; k < 2; ++k) {  // a quarter turn clockwise: down through the block
        angle -= 45;
        pose.rotation = turned(angle, vec3(0, 0, 1));
        (*world)->step({.gravity = p.gravity, .poses = std::span(&pose, 1)}, 0.0125);
    }
    size_t behind = 0;
    for (const vec3& x : places(**world)) {
        const vec3 own = pose.toOwn(x);  // the blade came from +y of its own frame, so nothing may be there within its reach
        behind += own.y > 0 && own.x > 0.03F && own.x < 0.85F && std::abs(own.z) < 0.45F ? 1 : 0;
    }
    EXPECT_EQ(behind, 0U);
    EXPECT_EQ((*world)->stats().lost, 0U);
}

// A sheet moves up and down under a pool, in frames of 4 to 60 ms: the pool stays on top of it and moves with it.
TEST(MovingSolid, ABendingSheetCarriesItsPool) {
    auto device = cpu();
    const float spacing = 0.04F;
    FluidParams p = fluid(vec3(0), vec3(1, 1.2F, 0.4F), spacing, vec3(0, 0.44F, 0), vec3(1, 0.6F, 0.4F));
    test::Mesh sheet;
    constexpr int kX = 48, kZ = 8;
    for (int z = 0; z <= kZ; ++z)
        for (int x = 0; x <= kX; ++x)
            sheet.positions.emplace_back(-0.1F + 1.2F * static_cast<float>(x) / kX, 0.4F, -0.1F + 0.6F * static_cast<float>(z) / kZ);
    for (uint32_t z = 0; z < kZ; ++z)
        for (uint32_t x = 0; x < kX; ++x) {
            const uint32_t a = z * (kX + 1) + x;
            for (uint32_t i : {a, a + kX + 2, a + 1, a, a + kX + 1, a + kX + 2}) sheet.indices.push_back(i);
        }
    const auto heave = [&](double time) {
        std::vector<vec3> now = sheet.positions;
        const auto t = static_cast<float>(time);
        for (vec3& v : now) v.y += 0.12F * std::sin(5.0F * t) * std::cos(7.0F * v.x - 2.0F * t);
        return now;
    };
    Bounds reach;
    for (const vec3& v : sheet.positions) reach.add(v);
    reach.min.y -= 0.13F;
    reach.max.y += 0.13F;
    const MeshView view = sheet.view();
    Result<DeformingField> field =
        DeformingField::create(std::span(&view, 1), reach,
                               {.resolution = static_cast<int>(1.2F / (0.25F * spacing)), .band = 2 * spacing, .padding = 2 * spacing});
    ASSERT_TRUE(field) << field.error().message;
    auto world = FluidWorld::create(*device, p, {.deforming = {&*field}}, {});
    ASSERT_TRUE(world) << world.error().message;
    ASSERT_GT((*world)->particles().count, 800U);
    double time = 0;
    for (int k = 0; k < 80; ++k) {
        const double seconds = k % 10 == 7 ? 0.06 : 0.004 + 0.002 * (k % 7);
        time += seconds;
        const std::vector<vec3> shape = heave(time);
        const std::span<const vec3> vertices(shape);
        (*world)->step({.gravity = p.gravity, .shapes = std::span(&vertices, 1)}, seconds);
        size_t below = 0, inside = 0;
        for (const vec3& x : places(**world)) {
            const auto t = static_cast<float>(time);
            const float height = 0.4F + 0.12F * std::sin(5.0F * t) * std::cos(7.0F * x.x - 2.0F * t);
            below += x.y < height ? 1 : 0;
            inside += inSetVoxel(field->field().surface, vec4(x, 1)) ? 1 : 0;
        }
        ASSERT_EQ(below, 0U) << "frame " << k;
        ASSERT_EQ(inside, 0U) << "frame " << k;
    }
    EXPECT_EQ((*world)->stats().lost, 0U);
    EXPECT_GT((*world)->voxelsRewritten(), 100000U);
}

// Two adjacent floors with different friction: one particle slides on, the other is held.
TEST(MovingSolid, EachWallHasItsOwnFriction) {
    auto device = cpu();
    const float spacing = 0.04F;
    const float slope = 20.0F * kPi / 180;
    const vec3 normal(std::sin(slope), std::cos(slope), 0);
    test::Mesh left = test::makeSheet(vec3(0, 0, -0.5F), normal, 0.9F), right = test::makeSheet(vec3(0, 0, 0.5F), normal, 0.9F);
    const MeshView views[] = {left.view(), right.view()};
    const uint8_t surfaces[] = {3, 5};
    Result<VoxelField> field =
        bakeVoxelField(views, {.resolution = 200, .band = 2 * spacing, .padding = 2 * spacing, .surfaces = surfaces});
    ASSERT_TRUE(field) << field.error().message;
    FluidParams p = fluid(vec3(-2, -1, -1), vec3(2, 1, 1), spacing, vec3(0), vec3(0));
    p.blocks.clear();
    for (float z : {-0.5F, 0.5F})
        p.blocks.push_back({vec3(-0.2F, 0.12F, z), vec3(-0.2F + spacing, 0.12F + spacing, z + spacing), vec3(0.0F)});
    std::vector<Surface> table(6);
    table[3] = {0.0F, 0.0F};
    table[5] = {2.0F, 0.0F};
    auto world = FluidWorld::create(*device, p, {.field = &*field, .surfaces = table}, {});
    ASSERT_TRUE(world) << world.error().message;
    ASSERT_EQ((*world)->particles().count, 2U);
    for (int k = 0; k < 24; ++k) (*world)->step({.gravity = p.gravity}, 1.0 / 60);
    std::vector<vec3> x = places(**world);
    if (x[0].z > x[1].z) std::swap(x[0], x[1]);
    EXPECT_GT(x[0].x, 0.0F) << "without friction it slides";
    EXPECT_LT(x[1].x, -0.1F) << "with more than tan 20 degrees it is held";
}

// The thin cup: its wall is thinner than a voxel. Tilted and shaken for 20 s with frames of 4 to 250 ms, vertical at the end: no particle
// is lost or inside its wall; some may splash out of its opening (the hollow ball below has none).
TEST(MovingSolid, AThinCupHoldsItsWater) {
    Result<SceneFile> scene = loadScene(std::string(RIVULET_SOURCE_DIR) + "/assets/scenes/thin_cup.json", {});
    ASSERT_TRUE(scene) << scene.error().message;
    scene->fluid.spacing = 0.02F;
    scene->fluid.soundSpeed = 15;
    scene->fluid.longestFrame = 0.25F;
    ColliderMotion& motion = scene->colliders[0].motion;
    motion.keys.clear();
    for (int k = 0; k <= 10; ++k) {  // tilted to both sides, without pouring
        ColliderKey key;
        key.time = 2.0F * static_cast<float>(k);
        key.rotation = vec3(0, 0, k % 2 == 1 ? (k % 4 == 1 ? 30.0F : -30.0F) : 0.0F);
        motion.keys.push_back(key);
    }
    auto device = cpu();
    auto session = Session::create(*scene, *device, {});
    ASSERT_TRUE(session) << session.error().message;
    FluidWorld& world = (*session)->world();
    const VoxelField& cup = *(*session)->fields().rigid[0];
    EXPECT_LE(cup.surface.voxel, 0.2501F * scene->fluid.spacing) << "the default voxel is at most a quarter of the spacing";
    const float wall = 0.01F * 0.36F / 1.2F;
    EXPECT_LT(wall, cup.surface.voxel) << "the wall is thinner than a voxel";
    const uint32_t count = world.particles().count;
    ASSERT_GT(count, 600U);
    std::mt19937 random(9);
    std::uniform_real_distribution<double> at(0.0, 1.0);
    size_t inWall = 0;
    double time = 0;
    while (time < 20) {
        const double seconds = std::min(0.004 * std::pow(62.5, std::pow(at(random), 3.0)), 20.0001 - time);
        (*session)->step(seconds, true);
        time += seconds;
        for (const vec3& x : places(world)) inWall += inSetVoxel(cup.surface, vec4(world.poses()[0].toOwn(x), 1)) ? 1 : 0;
    }
    EXPECT_NEAR(world.time(), 20, 0.01);
    EXPECT_EQ(inWall, 0U);
    EXPECT_EQ(world.stats().lost, 0U);
    // In the cup's frame its axis is y, its opening at the top; the radius is 0.5 to 0.6 of a height of 1.2, which is scaled to 0.36.
    size_t within = 0;
    for (const vec3& x : places(world)) {
        const vec3 own = world.poses()[0].toOwn(x);
        within += own.y > -0.18F && own.y < 0.18F && std::hypot(own.x, own.z) < 0.18F ? 1 : 0;
    }
    EXPECT_GT(within, count * 95 / 100) << "a splash may leave by the mouth; nothing leaves through the wall";
    // Distance of the centres to the triangles, by brute force.
    Result<Mesh> mesh = importMesh(std::string(RIVULET_SOURCE_DIR) + "/assets/meshes/thin_cup.obj");
    ASSERT_TRUE(mesh);
    const Mesh placed = transformed(*mesh, Transform::fitted(mesh->bounds(), 0.36F, vec3(0), vec3(0)));
    double nearest = 1;
    for (const vec3& x : places(world)) {
        const vec3 own = world.poses()[0].toOwn(x);
        for (size_t t = 0; t < placed.indices.size(); t += 3)
            nearest = std::min(
                nearest, distanceTo(dvec3(own), dvec3(placed.positions[placed.indices[t]]), dvec3(placed.positions[placed.indices[t + 1]]),
                                    dvec3(placed.positions[placed.indices[t + 2]])));
    }
    const auto contact = static_cast<double>(fieldParams(cup, {.spacing = world.params().spacing}).contact);
    EXPECT_GE(nearest, std::sqrt(3.0) * static_cast<double>(cup.surface.voxel)) << "hence in no set voxel";
    EXPECT_NEAR(nearest, contact, 0.1 * contact);
    std::printf("thin cup: centres keep %.5f m from the triangles; stand-off %.5f m\n", nearest,
                nearest - 0.5 * static_cast<double>(world.params().spacing));
    std::printf("thin cup: wall %.4f m, voxel %.4f m, %zu of %u particles in it after 20 s\n", static_cast<double>(wall),
                static_cast<double>(cup.surface.voxel), within, count);
}

// A block moves through a pool into each wall of the box and into a plane: the pushed particles return, none is lost.
TEST(MovingSolid, NothingIsPushedOutOfTheBox) {
    for (int wall = 0; wall < 7; ++wall) {
        auto device = cpu();
        const float spacing = 0.05F;
        FluidParams p = fluid(vec3(-0.5F), vec3(0.5F), spacing, vec3(-0.4F), vec3(0.4F));
        p.gravity = vec3(0.0F);
        const VoxelField block = test::baked(test::makeBox(vec3(-0.2F), vec3(0.2F)), 0.25F * spacing, spacing);
        vec3 way(0.0F);
        way[wall % 3] = wall < 3 ? 1.0F : -1.0F;
        if (wall == 6) way = glm::normalize(vec3(1, 1, 0));
        Solids solids{.rigid = {{&block, Pose{-1.5F * way, quat(1, 0, 0, 0)}}}};
        if (wall == 6) solids.planes = {{0.45F * way, -way}};
        auto world = FluidWorld::create(*device, p, solids, {});
        ASSERT_TRUE(world) << world.error().message;
        ASSERT_GT((*world)->particles().count, 2000U);
        Pose pose = solids.rigid[0].pose;
        for (int k = 1; k <= 24; ++k) {
            pose.position = way * (-1.5F + 2.1F * static_cast<float>(k) / 24);  // until half of it is outside the box
            (*world)->step({.gravity = p.gravity, .poses = std::span(&pose, 1)}, 1.0 / 60);
        }
        EXPECT_EQ((*world)->stats().lost, 0U) << "wall " << wall;
        for (const vec3& x : places(**world)) {
            ASSERT_TRUE(glm::all(glm::lessThanEqual(glm::abs(x), vec3(0.5F)))) << "wall " << wall;
            if (wall == 6) ASSERT_LE(glm::dot(x, way), 0.45F);
        }
    }
}

// An invalid shape from a host changes nothing: the mesh keeps its shape and continues with the next valid one.
TEST(MovingSolid, ABadShapeIsRefusedAndTheNextOneTaken) {
    auto device = cpu();
    const float spacing = 0.05F;
    const FluidParams p = fluid(vec3(-1), vec3(1), spacing, vec3(-0.5F, 0.3F, -0.5F), vec3(0.5F, 0.6F, 0.5F));
    const test::Mesh sheet = test::makeSheet(vec3(0), vec3(0, 1, 0), 1.0F);
    Bounds reach;
    for (const vec3& v : sheet.positions) reach.add(v);
    reach.min.y -= 0.2F;
    reach.max.y += 0.2F;
    const MeshView view = sheet.view();
    auto field = DeformingField::create(std::span(&view, 1), reach, {.resolution = 60, .band = 2 * spacing, .padding = 2 * spacing});
    ASSERT_TRUE(field) << field.error().message;
    auto world = FluidWorld::create(*device, p, {.deforming = {&*field}}, {});
    ASSERT_TRUE(world) << world.error().message;
    const auto lifted = [&](float by) {
        std::vector<vec3> now = sheet.positions;
        for (vec3& v : now) v.y += by;
        return now;
    };
    const auto step = [&](const std::vector<vec3>& shape) {
        const std::span<const vec3> vertices(shape);
        (*world)->step({.gravity = p.gravity, .shapes = std::span(&vertices, 1)}, 1.0 / 60);
    };
    step(lifted(0.05F));
    EXPECT_NEAR(field->positions()[0].y, 0.05F, 1e-5F);
    step(lifted(std::numeric_limits<float>::quiet_NaN()));
    step(lifted(0.5F));  // beyond its reach
    EXPECT_NEAR(field->positions()[0].y, 0.05F, 1e-5F);
    EXPECT_GE((*world)->stats().limited.size(), 1U) << "it is said";
    step(lifted(0.1F));
    EXPECT_NEAR(field->positions()[0].y, 0.1F, 1e-5F);
    // The same for poses: a refused pose does not repeat the last one.
    EXPECT_EQ((*world)->stats().lost, 0U);
}

// Water between two balls, the wall outside them thinner than a voxel, shaken and turned for 6 s in frames of 4 to 250 ms: without an
// opening, every particle is inside at the end of every frame.
TEST(MovingSolid, AThinHollowBallKeepsEveryParticle) {
    const float outer = 0.3F, inner = 0.297F, spacing = 0.025F;
    test::Mesh ball = test::makeSphere(vec3(0), outer, 40);
    const test::Mesh hollow = test::makeSphere(vec3(0), inner, 40);
    for (size_t t = 0; t < hollow.indices.size(); t += 3)
        ball.triangle(hollow.positions[hollow.indices[t]], hollow.positions[hollow.indices[t + 2]],
                      hollow.positions[hollow.indices[t + 1]]);
    const VoxelField field = test::baked(ball, 0.25F * spacing, spacing);
    ASSERT_GT(field.surface.voxel, outer - inner);
    auto device = cpu();
    FluidParams p = fluid(vec3(-1), vec3(1), spacing, vec3(-0.28F, -0.28F, -0.28F), vec3(0.28F, 0.0F, 0.28F));
    p.longestFrame = 0.25F;
    p.soundSpeed = 15;
    Pose pose{vec3(0), quat(1, 0, 0, 0)};
    Solids solids{.rigid = {{&field, pose}}};
    auto world = FluidWorld::create(*device, p, solids, {});
    ASSERT_TRUE(world) << world.error().message;
    // The block is larger than the ball: particles spawned outside fall away and do not count.
    const HostParticles first = readParticles(**world);
    std::vector<bool> ours(first.id.size());
    size_t count = 0;
    for (size_t i = 0; i < first.id.size(); ++i)
        if (glm::length(vec3(first.position[i])) < inner) ours[first.id[i]] = true, ++count;
    ASSERT_GT(count, 1000U);
    std::mt19937 random(4);
    std::uniform_real_distribution<double> at(0.0, 1.0);
    double time = 0;
    while (time < 6) {
        const double seconds = 0.004 * std::pow(62.5, std::pow(at(random), 3.0));
        time += seconds;
        const auto t = static_cast<float>(time);
        pose.position = 0.08F * vec3(std::sin(7 * t), std::sin(9 * t), std::sin(5 * t));
        pose.rotation = turned(60 * t, vec3(1, 2, 0.5F));
        (*world)->step({.gravity = p.gravity, .poses = std::span(&pose, 1)}, seconds);
        const HostParticles now = readParticles(**world);
        size_t within = 0;
        for (size_t i = 0; i < now.id.size(); ++i)
            within += ours[now.id[i]] && glm::length((*world)->poses()[0].toOwn(vec3(now.position[i]))) < inner ? 1 : 0;
        ASSERT_EQ(within, count) << "after " << time << " s";
    }
    EXPECT_EQ((*world)->stats().lost, 0U);
}

// Every shipped scene runs: no particle is lost, in a solid or NaN.
TEST(ShippedScenes, RunWithNothingLost) {
    for (const char* name : {"bunny_rain", "nested_shells", "paddle_wheel", "thin_cup", "valley", "waving_sheet", "rubber_ducks", "honey",
                             "oil_on_water", "hourglass", "wave_tank", "fountain", "koi"}) {
        Result<SceneFile> scene = loadScene(std::string(RIVULET_SOURCE_DIR) + "/assets/scenes/" + name + ".json", {});
        ASSERT_TRUE(scene) << scene.error().message;
        if (!scene->colliders.empty() && !findAsset(scene->colliders[0].mesh, scene->folder)) {
            std::printf("%s: its mesh is not here (assets/fetch_bunny.sh brings it)\n", name);
            continue;
        }
        scene->fluid.spacing *= 1.5F;  // a third of the particles
        auto device = cpu();
        auto session = Session::create(*scene, *device, {});
        ASSERT_TRUE(session) << session.error().message;
        RunRecorder recorder((*session)->world(), (*session)->fields(), true);
        for (int frame = 0; frame < 15; ++frame) recorder.stepped((*session)->step(1.0 / kFramesPerSecond, true), {});
        const RunStats stats = recorder.finish(name);
        EXPECT_GT(stats.particles, 500U) << name;
        EXPECT_EQ(stats.lost, 0U) << name;
        EXPECT_EQ(stats.nan, 0U) << name;
        EXPECT_EQ(stats.penetrations, 0U) << name;
        EXPECT_EQ(stats.voxelsRewritten > 0, std::string(name) == "waving_sheet" || std::string(name) == "koi");
    }
}

}  // namespace
}  // namespace rivulet::solids_moving_test
