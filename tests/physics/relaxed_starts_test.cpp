// Blocks start in disorder and without a surplus of density; against the conservation of energy and the block's own velocity field.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "fluid/sim/world/host_particles.h"
#include "tests/physics/worlds.h"

namespace rivulet::relaxed_starts_test {
namespace {

// A start has no surplus of density that becomes velocity: a drop of particles in disorder flies on with the energy that it was given.
TEST(RelaxedStart, DisorderDoesNotBecomeVelocity) {
    for (const char* method : {"pbf", "dfsph", "wcsph"})
        for (const float jitter : {0.2F, 0.5F}) {
            FluidParams p;
            p.method = method;
            p.spacing = 0.02F;
            p.gravity = vec3(0.0F);
            p.blocks = {{.min = vec3(0.3F), .max = vec3(0.6F), .velocity = vec3(0, 0.5F, 0), .jitter = jitter}};
            auto device = cpu();
            auto world = makeWorld(*device, p);
            const double given = 0.5 * static_cast<double>(world->particles().count) * 1000 * 8.0e-6 * 0.25;
            for (int frame = 0; frame < 6; ++frame) {
                world->step({}, 1.0 / 60);
                EXPECT_NEAR(world->stats().kinetic / given, 1, 1.0e-3) << method << ", jitter " << jitter << ", frame " << frame;
            }
        }
}

// A large start takes the inside of blocks from a tile and corrects only what is too dense: it is as still as a small one, also at the seam
// of two blocks and beside a wall and a plane.
TEST(RelaxedStart, ALargeStartIsAsStill) {
    FluidParams p;
    p.method = "wcsph";
    p.spacing = 0.01F;
    p.gravity = vec3(0.0F);
    p.box.max = vec3(1.2F, 1.0F, 0.7F);
    p.blocks = {{.min = vec3(0.0F), .max = vec3(0.65F, 0.65F, 0.35F)}, {.min = vec3(0, 0, 0.35F), .max = vec3(0.65F, 0.65F, 0.7F)}};
    Solids solids;
    solids.planes = {{.position = vec3(0.08F, 0.06F, 0.0F), .normal = vec3(0.8F, 0.6F, 0.0F)}};
    auto device = cpu();
    std::vector<double> shares;
    auto world = FluidWorld::create(*device, p, solids, {}, {}, {}, [&](double share) {
        shares.push_back(share);
        return true;
    });
    ASSERT_TRUE(world) << world.error().message;
    ASSERT_GT((*world)->particles().count, 1U << 18U) << "a large start";
    (*world)->step({}, 1.0e-6);
    EXPECT_LT((*world)->stats().maxCompression, 0.012);
    EXPECT_LT((*world)->stats().avgCompression, 0.0015);
    EXPECT_GT(shares.size(), 10U);
    EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
    EXPECT_GE(shares.front(), 0);
    EXPECT_LE(shares.back(), 1);
    // The pressure of 1 % at a speed of sound of ten times a metre per second would give 0.1 m/s.
    (*world)->step({}, 1.0 / 60);
    const FluidStats& now = (*world)->stats();
    EXPECT_LT(std::sqrt(2 * now.kinetic / (now.particles * 1.0e-6 * 1000)), 0.01);
    EXPECT_EQ(now.lost, 0U);
}

// Whoever watches a start can cancel it, whatever its size.
TEST(RelaxedStart, CanBeCancelled) {
    for (const float spacing : {0.02F, 0.009F}) {
        FluidParams p;
        p.spacing = spacing;
        p.blocks = {{.min = vec3(0.0F), .max = vec3(0.6F)}};
        auto device = cpu();
        int calls = 0;
        const auto world = FluidWorld::create(*device, p, {}, {}, {}, {}, [&](double) { return ++calls < 2; });
        ASSERT_FALSE(world);
        EXPECT_EQ(world.error().fault, Fault::failed);
        EXPECT_NE(world.error().message.find("cancelled"), std::string::npos) << world.error().message;
        EXPECT_EQ(calls, 2) << "nothing goes on afterwards";
    }
}

// Blocks that overlap come apart before time begins: together they have the volume of both, and nothing is thrown.
TEST(RelaxedStart, OverlappingBlocksComeApart) {
    FluidParams p;
    p.method = "dfsph";
    p.spacing = 0.02F;
    p.gravity = vec3(0.0F);
    p.blocks = {{.min = vec3(0.3F), .max = vec3(0.5F)}, {.min = vec3(0.45F, 0.3F, 0.3F), .max = vec3(0.65F, 0.5F, 0.5F)}};
    auto device = cpu();
    auto world = makeWorld(*device, p);
    ASSERT_EQ(world->particles().count, 2000U);
    world->step({}, 1.0e-4);
    EXPECT_LT(world->stats().maxCompression, 0.02) << "before: 1, where two lattices are in one place";
    for (int frame = 0; frame < 6; ++frame) world->step({}, 1.0 / 60);
    EXPECT_LT(world->stats().maxSpeed, 0.1);
}

// The same start on every device, and again after a reset; velocities are those of the block's field at the new places. Particles that the
// host placed stay where they are.
TEST(RelaxedStart, IsTheSameAfterAReset) {
    FluidParams p;
    p.spacing = 0.02F;
    p.gravity = vec3(0.0F);
    p.blocks = {{.min = vec3(0.3F), .max = vec3(0.5F), .spin = vec3(0, 3, 0)}};
    auto device = cpu();
    std::vector<NewParticle> placed(5);
    for (size_t k = 0; k < placed.size(); ++k) placed[k].position = vec3(0.7F, 0.5F, 0.5F + 0.01F * static_cast<float>(k));
    auto world = FluidWorld::create(*device, p, {}, {}, {.particles = placed});
    ASSERT_TRUE(world) << world.error().message;
    const HostParticles first = readParticles(**world);
    (*world)->step({}, 1.0 / 60);
    (*world)->reset();
    const HostParticles again = readParticles(**world);
    ASSERT_EQ(first.position.size(), 1005U);
    EXPECT_EQ(first.position, again.position);
    EXPECT_EQ(first.velocity, again.velocity);
    for (size_t k = 0; k < first.id.size(); ++k) {
        const vec3 at(first.position[k]);
        if (first.id[k] >= 1000)
            EXPECT_EQ(at, placed[first.id[k] - 1000].position);
        else
            EXPECT_LT(glm::distance(vec3(first.velocity[k]), glm::cross(vec3(0, 3, 0), at - 0.4F)), 1.0e-5F);
    }
}

}  // namespace
}  // namespace rivulet::relaxed_starts_test
