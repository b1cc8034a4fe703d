// Particles against the static field: none enters it, none passes through, none sticks.
#include <gtest/gtest.h>

#include "fluid/sim/solids/solids.h"
#include "fluid/voxel/voxel_field.h"
#include "tests/physics/collide_unit.h"
#include "tests/unit/voxel_test_meshes.h"

namespace rivulet::collide_test {
namespace {

// Free particles (no pressure) under gravity and the collide kernel, in the order of a step of the fluid.
struct World {
    VoxelField field;
    alignas(16) FieldParams params{};
    std::vector<vec4> previous, position, velocity;
    bool thesis = false;

    World(const test::Mesh& mesh, int resolution, float spacing, float friction = 0, float restitution = 0) {
        const MeshView view = mesh.view();
        VoxelFieldOptions options;
        options.resolution = resolution;
        options.band = 1.5F * spacing;
        Result<VoxelField> baked = bakeVoxelField(std::span(&view, 1), options);
        EXPECT_TRUE(baked);
        field = std::move(*baked);
        FieldContact contact;
        contact.spacing = spacing;
        contact.restSpeed = 0.05F;
        contact.countIndex = 2;
        params = fieldParams(field, contact);
        for (uint32_t word : surfaceWords({}, {friction, restitution})) field.normal.push_back(word);
    }

    // Only positions where a particle may be spawned: at contact distance or further away.
    bool add(const vec3& p, const vec3& v) {
        if (field.clearance(p) < params.contact) return false;
        position.emplace_back(p, 0.25F);
        velocity.emplace_back(v, 0.75F);
        return true;
    }
    void step(const vec3& gravity, float dt) {
        previous = position;
        for (size_t i = 0; i < position.size(); ++i) {
            velocity[i] += vec4(gravity * dt, 0);
            position[i] += vec4(vec3(velocity[i]) * dt, 0);
        }
        collide();
    }
    void collide() {
        const auto count = static_cast<uint32_t>(position.size());
        const uint32_t cellStart[3] = {0, 0, count};
        void* buffers[] = {previous.data(),           position.data(),       velocity.data(),    const_cast<uint32_t*>(cellStart),
                           field.surface.bits.data(), field.distance.data(), field.normal.data()};
        (thesis ? test::collideThesis : test::collide)(0, count, &params, buffers);
    }
    vec3 at(size_t i) const { return vec3(position[i]); }
    vec3 speed(size_t i) const { return vec3(velocity[i]); }
    // Counted from the bits, independent of the collision code.
    size_t penetrations() const {
        size_t n = 0;
        for (const vec4& p : position) n += field.surface.test(field.surface.cellOf(vec3(p))) ? 1 : 0;
        return n;
    }
};

std::mt19937 random_(1);
float uniform(float low, float high) { return std::uniform_real_distribution<float>(low, high)(random_); }
vec3 direction() {
    for (;;) {
        const vec3 v(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
        if (glm::dot(v, v) < 1 && glm::dot(v, v) > 0.01F) return glm::normalize(v);
    }
}

// Particles hit a sphere from all directions, at speeds from nearly 0 to 40 voxels a step.
TEST(Collide, NothingEntersASphere) {
    random_.seed(1);
    World world(test::makeSphere(vec3(0), 0.5F, 40), 96, 0.02F);
    for (int k = 0; k < 4000; ++k) {
        const vec3 from = direction() * uniform(0.55F, 0.9F);
        world.add(from, (direction() * 0.5F - from) * std::exp(uniform(-2.0F, 3.8F)));
    }
    ASSERT_GT(world.position.size(), 3000U);
    size_t hits = 0;
    for (int step = 0; step < 300; ++step) {
        const auto before = world.velocity;
        world.step(vec3(0, -9.81F, 0) * (step < 150 ? 1.0F : -1.0F), 0.005F);
        ASSERT_EQ(world.penetrations(), 0U) << "step " << step;
        for (size_t i = 0; i < world.position.size(); ++i) {
            // The mesh lies inside its sphere by up to the sagitta; contact is measured to the mesh.
            ASSERT_GT(glm::length(world.at(i)), 0.5F * std::cos(kPi / 40) + 0.9F * world.params.contact)
                << "particle " << i << ", step " << step;
            ASSERT_EQ(world.position[i].w, 0.25F);
            ASSERT_EQ(world.velocity[i].w, 0.75F);
            hits += glm::dot(world.speed(i) - vec3(before[i]), world.at(i)) > 0.2F ? 1 : 0;
        }
    }
    EXPECT_GT(hits, 2000U);
}

// A room has walls without thickness, at any angle to the grid: no particle leaves it.
TEST(Collide, NothingLeavesARoomOfSheets) {
    random_.seed(2);
    for (int turn = 0; turn < 4; ++turn) {
        const vec3 axis = direction();
        const mat3 turned = [&] {
            const vec3 u = glm::normalize(glm::cross(axis, vec3(0.3F, 0.9F, 0.2F)));
            return turn == 0 ? mat3(1.0F) : mat3(u, glm::cross(axis, u), axis);
        }();
        test::Mesh room = test::makeBox(vec3(-0.4F, -0.3F, -0.5F), vec3(0.4F, 0.3F, 0.5F));
        for (vec3& p : room.positions) p = turned * p;
        World world(room, 60, 0.04F, uniform(0, 0.5F), uniform(0, 0.9F));
        for (int k = 0; k < 1500; ++k)
            world.add(turned * vec3(uniform(-0.36F, 0.36F), uniform(-0.26F, 0.26F), uniform(-0.46F, 0.46F)),
                      direction() * std::exp(uniform(-2.0F, 4.0F)));
        ASSERT_GT(world.position.size(), 1000U);
        size_t near = 0;
        for (int step = 0; step < 300; ++step) {
            // Shaken, with frames of 2 to 30 ms.
            world.step(
                turned * vec3(30 * std::sin(0.1F * static_cast<float>(step)), -9.81F, 20 * std::cos(0.13F * static_cast<float>(step))),
                step % 50 == 7 ? 0.03F : 0.002F);
            ASSERT_EQ(world.penetrations(), 0U) << "step " << step;
            for (size_t i = 0; i < world.position.size(); ++i) {
                const vec3 p = glm::transpose(turned) * world.at(i);
                const float inside = std::min(0.4F - std::abs(p.x), std::min(0.3F - std::abs(p.y), 0.5F - std::abs(p.z)));
                ASSERT_GT(inside, 0.97F * world.params.contact) << "particle " << i << ", step " << step;
                near += inside < 1.05F * world.params.contact ? 1 : 0;
            }
        }
        EXPECT_GT(near, 10000U);
    }
}

// Random triangles, needles and slivers: no particle enters a set voxel, even where distances are inexact.
TEST(Collide, NothingEntersRandomTriangles) {
    random_.seed(3);
    for (unsigned seed = 1; seed <= 3; ++seed) {
        World world(test::makeJumble(seed, 28), 64, 0.02F);
        for (int k = 0; k < 4000; ++k)
            world.add(vec3(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)), direction() * std::exp(uniform(-2.0F, 4.0F)));
        for (int step = 0; step < 150; ++step) {
            world.step(vec3(0, -9.81F, 0), 0.004F);
            ASSERT_EQ(world.penetrations(), 0U) << "step " << step;
        }
    }
}

// accuracy.md: within 5 % of g sin 7 degrees, for any rotation of the slope relative to the grid.
TEST(Collide, SlidesDownAGentleSlope) {
    const float slope = 7.0F * kPi / 180;
    for (float turn : {0.0F, 0.4F, 0.785398F, 1.3F}) {
        const vec3 down(std::cos(turn) * std::cos(slope), -std::sin(slope), std::sin(turn) * std::cos(slope));
        const vec3 normal(std::cos(turn) * std::sin(slope), std::cos(slope), std::sin(turn) * std::sin(slope));
        World world(test::makeSheet(vec3(0), normal, 3.0F), 128, 0.05F);
        ASSERT_TRUE(world.add(normal * (1.8F * world.params.contact) - 0.8F * down, vec3(0)));
        // First the particle falls onto the slope and comes to rest.
        for (int step = 0; step < 100; ++step) world.step(vec3(0, -9.81F, 0), 0.002F);
        const float from = glm::dot(world.speed(0), down);
        for (int step = 0; step < 200; ++step) {
            world.step(vec3(0, -9.81F, 0), 0.002F);
            ASSERT_NEAR(glm::dot(world.at(0), normal), world.params.contact, 0.01F * world.params.voxel);
        }
        const float acceleration = (glm::dot(world.speed(0), down) - from) / 0.4F;
        EXPECT_NEAR(acceleration, 9.81F * std::sin(slope), 0.01F * 9.81F * std::sin(slope)) << "turned by " << turn;
        EXPECT_LT(std::abs(glm::dot(world.speed(0), normal)), 0.03F);
    }
}

// The same slope with the collision of the thesis: normals of smoothed voxels follow the staircase of the voxels, and the particle sticks
// on a step.
TEST(Collide, SticksOnAGentleSlopeInThesisMode) {
    const float slope = 7.0F * kPi / 180;
    const vec3 down(std::cos(slope), -std::sin(slope), 0), normal(std::sin(slope), std::cos(slope), 0);
    World world(test::makeSheet(vec3(0), normal, 3.0F), 128, 0.05F);
    world.thesis = true;
    for (int k = 0; k < 20; ++k)
        ASSERT_TRUE(world.add(normal * (1.8F * world.params.contact) - (0.8F - 0.005F * static_cast<float>(k)) * down, vec3(0)));
    for (int step = 0; step < 100; ++step) world.step(vec3(0, -9.81F, 0), 0.002F);
    std::vector<float> from;
    for (size_t i = 0; i < world.position.size(); ++i) from.push_back(glm::dot(world.at(i), down));
    for (int step = 0; step < 400; ++step) world.step(vec3(0, -9.81F, 0), 0.002F);
    const float free = 0.5F * 9.81F * std::sin(slope) * 0.8F * 0.8F;
    float mean = 0;
    size_t stuck = 0;
    for (size_t i = 0; i < world.position.size(); ++i) {
        const float way = glm::dot(world.at(i), down) - from[i];
        mean += way / static_cast<float>(world.position.size());
        stuck += way < 0.1F * free ? 1 : 0;
    }
    std::printf("thesis mode, 7 degrees: in 0.8 s they slide %.3f m of %.3f m, %zu of 20 stick\n", static_cast<double>(mean),
                static_cast<double>(free), stuck);
    EXPECT_LT(mean, 0.5F * free);
    EXPECT_GT(stuck, 5U);
}

// Coulomb: on a 30 degree slope, friction 0.3 slows by mu g cos a; friction 0.7 > tan 30 holds.
TEST(Collide, FrictionSlowsAndHolds) {
    const float slope = kPi / 6;
    const vec3 down(std::cos(slope), -std::sin(slope), 0), normal(std::sin(slope), std::cos(slope), 0);
    for (float friction : {0.3F, 0.7F}) {
        World world(test::makeSheet(vec3(0), normal, 3.0F), 128, 0.05F, friction);
        ASSERT_TRUE(world.add(normal * (1.8F * world.params.contact) - 0.5F * down, vec3(0)));
        for (int step = 0; step < 100; ++step) world.step(vec3(0, -9.81F, 0), 0.002F);
        const vec3 start = world.at(0);
        const float from = glm::dot(world.speed(0), down);
        for (int step = 0; step < 200; ++step) world.step(vec3(0, -9.81F, 0), 0.002F);
        const float acceleration = (glm::dot(world.speed(0), down) - from) / 0.4F;
        if (friction < 0.5F) {
            EXPECT_NEAR(acceleration, 9.81F * (std::sin(slope) - friction * std::cos(slope)), 0.05F);
        } else {
            EXPECT_LT(glm::length(world.at(0) - start), 1e-5F) << "static friction holds";
        }
    }
}

// A particle dropped from 0.2 m rises to restitution^2 of that height and finally comes to rest.
TEST(Collide, BounceHeightIsRestitutionSquared) {
    World world(test::makeSheet(vec3(0), vec3(0, 1, 0), 2.0F), 64, 0.05F, 0.0F, 0.6F);
    const float floor = world.params.contact;
    ASSERT_TRUE(world.add(vec3(0.1F, floor + 0.2F, 0.1F), vec3(0)));
    const float dt = 0.0005F;
    float highest = 0;
    bool touched = false;
    for (int step = 0; step < 1200; ++step) {
        world.step(vec3(0, -9.81F, 0), dt);
        touched = touched || world.speed(0).y > 0;
        if (touched && step < 1000) highest = std::max(highest, world.at(0).y - floor);
    }
    EXPECT_NEAR(highest, 0.36F * 0.2F, 0.005F);
    for (int step = 0; step < 4000; ++step) world.step(vec3(0, -9.81F, 0), dt);
    EXPECT_NEAR(world.at(0).y, floor, 0.01F * world.params.voxel);
    EXPECT_LT(glm::length(world.speed(0)), 2 * 9.81F * dt);
}

// In edges and corners of a box, with gravity towards all walls: the particle rests without jitter, at contact distance from each wall.
TEST(Collide, RestsInCorners) {
    random_.seed(5);
    for (int turn = 0; turn < 3; ++turn) {
        const vec3 axis = direction();
        const vec3 u = glm::normalize(glm::cross(axis, vec3(0.3F, 0.9F, 0.2F)));
        const mat3 turned = turn == 0 ? mat3(1.0F) : mat3(u, glm::cross(axis, u), axis);
        test::Mesh room = test::makeBox(vec3(-0.5F), vec3(0.5F));
        for (vec3& p : room.positions) p = turned * p;
        World world(room, 64, 0.06F);
        for (int k = 0; k < 300; ++k)
            world.add(turned * vec3(uniform(-0.4F, 0.4F), uniform(-0.4F, 0.4F), uniform(-0.4F, 0.4F)), direction() * uniform(0.0F, 3.0F));
        const vec3 gravity = turned * (9.81F * glm::normalize(vec3(-0.5F, -1.0F, -0.3F)));
        const float dt = 0.001F;
        for (int step = 0; step < 2500; ++step) world.step(gravity, dt);
        const auto rest = world.position;
        float fastest = 0, moved = 0, away = 0;
        for (int step = 0; step < 200; ++step) {
            world.step(gravity, dt);
            for (size_t i = 0; i < rest.size(); ++i) {
                fastest = std::max(fastest, glm::length(world.speed(i)));
                moved = std::max(moved, glm::length(vec3(world.position[i] - rest[i])));
                const vec3 p = glm::transpose(turned) * world.at(i) + 0.5F;
                for (int k = 0; k < 3; ++k) away = std::max(away, std::abs(p[k] - world.params.contact));
            }
        }
        EXPECT_LT(fastest, 2 * 9.81F * dt) << "turn " << turn;
        EXPECT_LT(moved, 0.01F * world.params.voxel) << "turn " << turn;
        EXPECT_LT(away, 0.1F * world.params.voxel) << "all are in the corner, and none is held off it";
        EXPECT_EQ(world.penetrations(), 0U);
    }
}

// Along a floor into a wall: the particle stops there and does not climb the wall.
TEST(Collide, StopsAtAWallAcrossItsWay) {
    test::Mesh step = test::makeSheet(vec3(0), vec3(0, 1, 0), 2.0F);
    step.quad(vec3(0.5F, 0, -1), vec3(0.5F, 1, -1), vec3(0.5F, 1, 1), vec3(0.5F, 0, 1));
    for (float speed : {0.3F, 2.0F, 15.0F}) {
        World world(step, 100, 0.05F);
        const float c = world.params.contact;
        ASSERT_TRUE(world.add(vec3(0.1F, 1.8F * c, 0.03F), vec3(0)));
        for (int k = 0; k < 300; ++k) world.step(vec3(0, -9.81F, 0), 0.001F);
        ASSERT_NEAR(world.at(0).y, c, 0.01F * world.params.voxel);
        world.velocity[0] = vec4(speed, 0, 0.4F, 0);
        const float z = world.at(0).z;
        const int steps = static_cast<int>(0.4F / speed / 0.001F) + 50;
        float highest = 0;
        for (int k = 0; k < steps; ++k) {
            world.step(vec3(0, -9.81F, 0), 0.001F);
            highest = std::max(highest, world.at(0).y - c);
        }
        EXPECT_LT(highest, 0.1F * world.params.voxel) << speed << " m/s";
        EXPECT_NEAR(world.at(0).x, 0.5F - c, 0.1F * world.params.voxel) << "neither held off nor in the wall";
        EXPECT_NEAR(world.speed(0).x, 0.0F, 0.02F);
        EXPECT_NEAR(world.speed(0).z, 0.4F, 0.004F) << "along the crease it keeps going";
        EXPECT_NEAR(world.at(0).z - z, 0.4F * 0.001F * static_cast<float>(steps), 0.02F);
    }
}

// Over the top of a smooth bump: the tangential velocity is kept.
TEST(Collide, KeepsItsSpeedAroundASphere) {
    World world(test::makeSphere(vec3(0), 0.5F, 90), 100, 0.03F);
    const float r = 0.5F + world.params.contact;
    world.position.emplace_back(0.0F, r, 0.0F, 0.0F);
    world.velocity.emplace_back(1.0F, 0.0F, 0.0F, 0.0F);
    // A force towards the centre, strong enough to keep contact: a circle at constant speed.
    for (int step = 0; step < 1500; ++step) {
        world.step(-20.0F * glm::normalize(world.at(0)), 0.001F);
        ASSERT_NEAR(glm::length(world.at(0)), r, 0.15F * world.params.voxel);
    }
    EXPECT_NEAR(glm::length(world.speed(0)), 1.0F, 0.05F);
}

// A channel too narrow for contact distance on both sides, but wider than its voxels: particles flow without clogging or jitter.
TEST(Collide, FlowsThroughANarrowChannel) {
    test::Mesh channel = test::makeSheet(vec3(0), vec3(0, 1, 0), 2.0F);
    const test::Mesh lid = test::makeSheet(vec3(0, 0.06F, 0), vec3(0, 1, 0), 2.0F);
    for (uint32_t i : lid.indices) channel.indices.push_back(i + static_cast<uint32_t>(channel.positions.size()));
    channel.positions.insert(channel.positions.end(), lid.positions.begin(), lid.positions.end());
    World world(channel, 120, 0.08F);
    ASSERT_GT(2 * world.params.contact, 0.06F);
    // Placed in the middle of the channel, where no particle would be spawned; the contract requires only that it is in no set voxel.
    for (int k = 0; k < 50; ++k) {
        world.position.emplace_back(-0.6F, 0.03F, uniform(-0.5F, 0.5F), 0.0F);
        world.velocity.emplace_back(0.5F, uniform(-0.2F, 0.2F), 0.0F, 0.0F);
    }
    ASSERT_EQ(world.penetrations(), 0U);
    for (int step = 0; step < 1000; ++step) {
        world.step(vec3(0, -9.81F, 0), 0.001F);
        ASSERT_EQ(world.penetrations(), 0U);
    }
    for (size_t i = 0; i < world.position.size(); ++i) {
        EXPECT_NEAR(world.at(i).x, -0.1F, 0.02F) << "particle " << i;
        EXPECT_LT(std::abs(world.speed(i).y), 0.1F);
    }
}

// Spawned nearer than the contact distance, where distances are inexact: the traversal of the voxels alone must stop the particle.
TEST(Collide, TheTraversalStopsParticlesWhereDistancesAreInexact) {
    random_.seed(8);
    World channel(
        [] {
            test::Mesh mesh;
            for (float y : {0.0F, 0.06F}) mesh.quad(vec3(-1, y, -1), vec3(1, y, -1), vec3(1, y, 1), vec3(-1, y, 1));
            return mesh;
        }(),
        120, 0.08F);
    World jumble(test::makeJumble(5, 40), 40, 0.08F);
    while (channel.position.size() < 2000) {
        channel.position.emplace_back(uniform(-0.5F, 0.5F), uniform(0.025F, 0.035F), uniform(-0.5F, 0.5F), 0.0F);
        channel.velocity.emplace_back(direction() * uniform(0.0F, 40.0F), 0.0F);
    }
    while (jumble.position.size() < 4000) {
        const vec3 p(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)), nudge(0.01F * jumble.params.voxel);
        const VoxelGrid& bits = jumble.field.surface;
        if (bits.test(bits.cellOf(p)) || bits.test(bits.cellOf(p - nudge)) || bits.test(bits.cellOf(p + nudge))) continue;
        jumble.position.emplace_back(p, 0.0F);
        jumble.velocity.emplace_back(direction() * uniform(0.0F, 40.0F), 0.0F);
    }
    ASSERT_EQ(jumble.penetrations(), 0U);
    for (int step = 0; step < 100; ++step) {
        for (World* world : {&channel, &jumble}) {
            world->step(vec3(0, -9.81F, 0), 0.003F);
            ASSERT_EQ(world->penetrations(), 0U) << "step " << step;
            for (vec4& v : world->velocity) v += vec4(direction() * uniform(0.0F, 10.0F), 0);
        }
        for (size_t i = 0; i < channel.position.size(); ++i) {
            const vec3 p = channel.at(i);
            ASSERT_TRUE(p.y > 0 && p.y < 0.06F) << "particle " << i << ", step " << step;
            if (std::max(std::abs(p.x), std::abs(p.z)) > 0.9F) channel.velocity[i] = vec4(0), channel.position[i] = vec4(0, 0.03F, 0, 0);
        }
    }
}

// Particles with NaN, infinity or no motion, outside the grid or beyond the active count are not changed.
TEST(Collide, DoesNotChangeInvalidOrInactiveParticles) {
    World world(test::makeSphere(vec3(0), 0.5F, 12), 32, 0.02F);
    const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
    const vec3 places[] = {vec3(nan), vec3(inf, 0, 0), vec3(1e20F, 0, 0), vec3(0.7F, 0, 0), vec3(5, 5, 5), vec3(0.9F, 0.1F, 0)};
    for (const vec3& p : places) {
        world.previous.emplace_back(0.7F, 0.0F, 0.0F, 1.0F);
        world.position.emplace_back(p, 1.0F);
        world.velocity.emplace_back(1.0F, 2.0F, 3.0F, 4.0F);
    }
    world.position.emplace_back(0.0F, 0.0F, 0.0F, 1.0F);  // would collide, were it active
    world.previous.emplace_back(0.7F, 0.0F, 0.0F, 1.0F);
    world.velocity.emplace_back(1.0F, 2.0F, 3.0F, 4.0F);
    const uint32_t active[] = {0, 0, 6};
    void* buffers[] = {world.previous.data(),         world.position.data(),           world.velocity.data(),
                       const_cast<uint32_t*>(active), world.field.surface.bits.data(), world.field.distance.data(),
                       world.field.normal.data()};
    test::collide(0, 7, &world.params, buffers);
    for (size_t i = 0; i < 6; ++i) {
        EXPECT_EQ(world.velocity[i], vec4(1, 2, 3, 4)) << i;
        EXPECT_TRUE(i == 0 || world.at(i) == places[i]) << i;
    }
    EXPECT_EQ(world.at(6), vec3(0));
}

}  // namespace
}  // namespace rivulet::collide_test
