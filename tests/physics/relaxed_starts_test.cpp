// Blocks start in disorder and without a surplus of density; against the conservation of energy and the block's own velocity field.
#include <gtest/gtest.h>

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
