// A world that runs out of memory stops and reports it without loss, and continues when memory is available again.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "tests/physics/worlds.h"

namespace rivulet::memory_test {
namespace {

// Particles packed so closely that the neighbour lists must grow in the first step.
FluidParams packed(const std::string& method, bool periodic = false) {
    FluidParams p;
    p.method = method;
    p.spacing = 0.04F;
    p.maxSubsteps = 4;
    p.dfsph.maxIterations = 5;
    p.box.max = vec3(0.4F, 0.4F, 0.24F);
    p.box.periodicZ = periodic;
    for (int k = 0; k < 60; ++k) p.blocks.push_back({.max = vec3(0.2F, 0.2F, 0.24F), .velocity = vec3(0.5F, 0.25F, 0.0F)});
    return p;
}

struct State {
    std::vector<vec4> position, velocity;
    std::vector<uint32_t> id;
};
State stateOf(FluidWorld& world) {
    const ParticleView v = world.particles();
    Device& d = world.device();
    return {d.readAll<vec4>(*v.position, v.slots), d.readAll<vec4>(*v.velocity, v.slots), d.readAll<uint32_t>(*v.id, v.slots)};
}

TEST(OutOfMemory, TheGridFailsAgainUntilThereIsMemory) {
    auto device = cpu();
    const FluidParams p = packed("dfsph");
    auto world = makeWorld(*device, p);
    ASSERT_TRUE(world);
    const State start = stateOf(*world);
    Result<NeighborGrid> grid =
        NeighborGrid::create(*device, Bounds{p.box.min, p.box.max}, p.supportSpacings * p.spacing, world->particles().slots);
    ASSERT_TRUE(grid);
    Result<Particles> particles = Particles::create(*device, world->particles().slots);
    ASSERT_TRUE(particles);
    device->writeAll<vec4>(particles->positionNext, start.position);
    device->writeAll<vec4>(particles->velocityNext, start.velocity);
    device->writeAll<uint32_t>(particles->id, start.id);
    StepParams step{};
    step.count = particles->count;
    grid->fill(step);
    device->limitMemory(device->bytesAllocated());
    for (int k = 0; k < 3; ++k) {
        const Status built = grid->build(step, *particles);
        ASSERT_FALSE(built) << "build " << k << " has no memory for its lists";
        EXPECT_EQ(built.error().fault, Fault::failed);
        EXPECT_EQ(device->readAll<uint32_t>(particles->id, particles->count), start.id);
    }
    device->limitMemory(SIZE_MAX);
    EXPECT_TRUE(grid->build(step, *particles));
}

class OutOfMemoryOf : public ::testing::TestWithParam<const char*> {};

TEST_P(OutOfMemoryOf, AWorldStopsReportsItAndContinuesLater) {
    for (const bool periodic : {false, true}) {
        if (periodic && std::string_view(GetParam()) == "wcsph_thesis") continue;
        auto device = cpu();
        auto world = makeWorld(*device, packed(GetParam(), periodic));
        ASSERT_TRUE(world);
        const State start = stateOf(*world);
        device->limitMemory(device->bytesAllocated());
        for (int k = 0; k < 3; ++k) world->step({}, 1.0 / 60);
        const std::vector<std::string>& limited = world->stats().limited;
        EXPECT_TRUE(std::any_of(limited.begin(), limited.end(), [](const std::string& s) {
            return s.starts_with("not enough memory for the neighbour lists: ");
        })) << GetParam();
        EXPECT_EQ(world->time(), 0);
        EXPECT_NEAR(world->time() + world->pending() + world->dropped(), 3.0 / 60, 1.0e-9);
        const State now = stateOf(*world);
        EXPECT_EQ(now.id, start.id);
        for (size_t i = 0; i < start.id.size(); ++i) {
            ASSERT_LT(glm::distance(vec3(now.position[i]), vec3(start.position[i])), 1.0e-6F) << GetParam() << ' ' << i;
            ASSERT_LT(glm::distance(vec3(now.velocity[i]), vec3(start.velocity[i])), 1.0e-3F) << GetParam() << ' ' << i;
        }
        device->limitMemory(SIZE_MAX);
        for (int k = 0; k < 2; ++k) world->step({}, 1.0 / 60);
        EXPECT_GT(world->time(), 0);
        EXPECT_EQ(world->stats().nan, 0U);
        EXPECT_EQ(world->stats().particles, start.id.size());
    }
}
INSTANTIATE_TEST_SUITE_P(Methods, OutOfMemoryOf, ::testing::Values("pbf", "dfsph", "wcsph", "wcsph_thesis"));

}  // namespace
}  // namespace rivulet::memory_test
