// A grid that covers a part of a large domain and follows the particles: the water flows as in a small domain, costs what it costs there,
// and no neighbour is lost where the window moves or its cells are wide.
#include <gtest/gtest.h>

#include <cmath>

#include "fluid/sim/world/host_particles.h"
#include "tests/physics/worlds.h"

namespace rivulet::window_grid_test {
namespace {

// A drop that flies at `velocity` from `centre`.
FluidParams drop(const vec3& boxMax, const vec3& centre, const vec3& velocity) {
    FluidParams p;
    p.method = "pbf";
    p.maxSubsteps = 1000;
    p.spacing = 0.1F;
    p.box.max = boxMax;
    p.gravity = vec3(0.0F);
    p.blocks = {{.min = centre - 0.5F, .max = centre + 0.5F, .velocity = velocity}};
    return p;
}

// The box is 1 km x 100 m x 1 km: 7,300 million cells, of which memory for 64 million was the limit.
TEST(WindowGrid, WaterInAKilometreFlowsAsInASmallBox) {
    const vec3 velocity(150, 0, 100);  // 13 cells in a frame, more than the room about the window
    const vec3 far(512, 50, 512), near(2, 2, 2);
    auto device = cpu(), other = cpu();
    auto large = makeWorld(*device, drop(vec3(1000, 100, 1000), far, velocity));
    const size_t bytes = device->bytesAllocated();
    auto small = makeWorld(*other, drop(vec3(40, 40, 40), near, velocity));
    ASSERT_TRUE(large && small);
    EXPECT_LT(bytes, 2 * other->bytesAllocated() + (64U << 20U)) << "4 million cells at most";
    int substeps = 0;
    for (int frame = 0; frame < 10; ++frame) {
        large->step({}, 1.0 / 60);
        small->step({}, 1.0 / 60);
        substeps += large->lastSubsteps();
    }
    const FluidStats &a = large->stats(), &b = small->stats();
    EXPECT_EQ(a.lost, 0U);
    EXPECT_EQ(a.particles, 1000U);
    // 30 m, many times the window. Each substep rounds a position there to half of 2^-14 m, which pbf takes for a part of its path.
    const double rounding = 0.5 / 16384, path = 30.05 / substeps;
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(a.centreOfMass[axis] - double{far[axis]}, double{velocity[axis]} / 6, 0.01 + substeps * rounding);
        EXPECT_NEAR(a.centreOfMass[axis] - double{far[axis]}, b.centreOfMass[axis] - double{near[axis]}, substeps * rounding);
    }
    EXPECT_NEAR(a.kinetic / b.kinetic, 1, 2 * rounding / path);
    EXPECT_NEAR(a.avgCompression, b.avgCompression, 0.1 * b.avgCompression + 1.0e-5);
    // A question and a start anew, which find the window elsewhere.
    const std::vector<vec3> inside = {far + vec3(a.centreOfMass[0] - double{far.x}, 0, a.centreOfMass[2] - double{far.z})};
    auto found = large->sample(inside);
    ASSERT_TRUE(found);
    EXPECT_GT((*found)[0].density, 0.9F);
    large->reset();
    found = large->sample(std::vector<vec3>{far});
    ASSERT_TRUE(found);
    EXPECT_GT((*found)[0].density, 0.9F);
}

// Two drops a kilometre apart: cells are then wider than the reach, and no pair is missed.
TEST(WindowGrid, FarApartCellsAreWider) {
    FluidParams p = drop(vec3(1000, 100, 1000), vec3(2, 50, 2), vec3(0, 0, 0));
    p.blocks.push_back({.min = vec3(995, 50, 995), .max = vec3(996, 51, 996)});
    FluidParams q = drop(vec3(10, 100, 10), vec3(2, 50, 2), vec3(0, 0, 0));
    auto device = cpu(), other = cpu();
    auto both = makeWorld(*device, p), one = makeWorld(*other, q);
    both->step({}, 1.0 / 60);
    one->step({}, 1.0 / 60);
    EXPECT_EQ(both->stats().lost, 0U);
    EXPECT_EQ(both->stats().particles, 2000U);
    const HostParticles now = readParticles(*both), alone = readParticles(*one);
    double denser = 0, of = 0;
    for (const vec4& x : now.position) denser += x.x < 500 ? double{x.w} : 0;
    for (const vec4& x : alone.position) of += double{x.w};
    EXPECT_NEAR(denser / of, 1, 1.0e-4);
}

// A nozzle in an empty domain: what it sends out is found, although nothing was there to be measured before.
TEST(WindowGrid, AFastJetIsFollowedFromTheStart) {
    auto device = cpu();
    FluidParams p;
    p.method = "pbf";
    p.maxSubsteps = 1000;
    p.spacing = 0.02F;
    p.box.max = vec3(1000, 100, 1000);
    p.gravity = vec3(0.0F);
    Sources sources;
    sources.emitters.resize(1);
    EmitterParams& e = sources.emitters[0].params;
    e.position = vec3(500, 50, 500);
    e.direction = vec3(1, 0, 0);
    e.radius = 0.05F;
    e.litresPerSecond = 157;  // 20 m/s
    auto made = FluidWorld::create(*device, p, {}, {}, sources);
    ASSERT_TRUE(made) << made.error().message;
    for (int frame = 0; frame < 12; ++frame) (*made)->step({}, 1.0 / 60);
    const FluidStats& f = (*made)->stats();
    EXPECT_GT(f.particles, 2000U);
    EXPECT_EQ(f.lost, 0U);
    float furthest = 0;
    for (const vec4& x : readParticles(**made).position) furthest = std::max(furthest, x.x - 500);
    EXPECT_NEAR(furthest, 20 * 12 / 60.0, 0.5);
}

// A world continues from a saved state with its window where the water was.
TEST(WindowGrid, IsWhereASavedStateWas) {
    auto device = cpu();
    auto world = makeWorld(*device, drop(vec3(1000, 100, 1000), vec3(100, 50, 100), vec3(60, 0, 0)));
    for (int frame = 0; frame < 20; ++frame) world->step({}, 1.0 / 60);
    WorldState state;
    world->save(state);
    world->step({}, 1.0 / 60);
    const HostParticles first = readParticles(*world);
    world->reset();
    world->step({}, 1.0 / 60);
    ASSERT_TRUE(world->restore(state));
    world->step({}, 1.0 / 60);
    EXPECT_EQ(world->stats().lost, 0U);
    EXPECT_EQ(world->stats().particles, 1000U);
    const HostParticles again = readParticles(*world);
    double furthest = 0;
    std::vector<vec3> byId(first.id.size());
    for (size_t k = 0; k < first.id.size(); ++k) byId[first.id[k]] = vec3(first.position[k]);
    for (size_t k = 0; k < again.id.size(); ++k)
        furthest = std::max(furthest, double{glm::distance(byId[again.id[k]], vec3(again.position[k]))});
    EXPECT_LT(furthest, 1.0e-3);
}

// A host that moves the origin of its coordinates tells the world so: particles, jets and walls stay where they are in space, to double
// precision, and the water flows on as if nothing had been.
TEST(OriginShift, MovesNothingInSpace) {
    FluidParams p = drop(vec3(4, 4, 4), vec3(2, 1, 2), vec3(0, 0, 0));
    p.gravity = vec3(0, -9.81F, 0);
    Solids solids;
    solids.planes = {{.position = vec3(0, 0.3F, 0), .normal = vec3(0.2F, 1, 0)}};
    Emitter jet;
    jet.params.position = vec3(3, 3, 3);
    jet.params.litresPerSecond = 50;
    jet.params.radius = 0.3F;
    auto device = cpu(), other = cpu();
    auto shifted = FluidWorld::create(*device, p, solids, {}, {.emitters = {jet}}),
         still = FluidWorld::create(*other, p, solids, {}, {.emitters = {jet}});
    ASSERT_TRUE(shifted && still);
    const dvec3 first(4.0e6, -12.5, 1.0e5);
    (*shifted)->setOrigin(first);
    dvec3 moved(0.0);
    for (int frame = 0; frame < 20; ++frame) {
        if (frame % 5 == 4) {
            const dvec3 by(1024.5 * frame, -3.25, 77.125);  // of the host's origin
            const dvec3 place = (*shifted)->toHost(vec3(1, 2, 3));
            (*shifted)->setOrigin((*shifted)->origin() - by);
            moved += by;
            EXPECT_EQ((*shifted)->toHost(vec3(1, 2, 3)), place - by);
        }
        (*shifted)->step({}, 1.0 / 60);
        (*still)->step({}, 1.0 / 60);
    }
    EXPECT_EQ((*shifted)->origin(), first - moved);
    EXPECT_EQ(readParticles(**shifted).position, readParticles(**still).position);
    EXPECT_EQ(readParticles(**shifted).velocity, readParticles(**still).velocity);
    EXPECT_GT((*shifted)->stats().particles, 1000U) << "the jet runs";
    EXPECT_EQ((*shifted)->fromHost((*shifted)->toHost(vec3(1, 2, 3))), vec3(1, 2, 3));
}

}  // namespace
}  // namespace rivulet::window_grid_test
