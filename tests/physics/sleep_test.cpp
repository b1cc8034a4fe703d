// fluid.sleep: calm water falls asleep where it is, everything that moves water wakes it, and what floats on it moves as without sleep.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "fluid/sim/solids/body_shapes.h"
#include "fluid/sim/surface/ellipsoids.h"
#include "tests/physics/baked_mesh.h"
#include "tests/physics/worlds.h"

namespace rivulet::sleep_test {
namespace {

constexpr float kSpacing = 0.02F;
constexpr double kFrame = 1.0 / 60;

FluidParams pool(const std::string& method, bool sleeps = true, const vec3& size = vec3(0.24F, 0.2F, 0.24F), float jitter = 0) {
    FluidParams p;
    p.method = method;
    p.spacing = kSpacing;
    p.sleep.on = sleeps;
    p.box.max = vec3(size.x, 2.0F * size.y, size.z);
    p.blocks = {{.min = vec3(0.0F), .max = size}};
    p.blocks[0].jitter = jitter;
    return p;
}

void run(FluidWorld& world, int frames) {
    for (int k = 0; k < frames; ++k) world.step({}, kFrame);
}

// Runs until all particles sleep; returns the frames that it took, or `most`.
int settle(FluidWorld& world, int most = 600) {
    int k = 0;
    for (; k < most && world.stats().asleep < world.stats().particles; ++k) run(world, 1);
    return k;
}

std::vector<vec4> byId(const FluidWorld& world, bool velocities = false) {
    const ParticleView view = world.particles();
    Device& device = world.device();
    const auto x = device.readAll<vec4>(velocities ? *view.velocity : *view.position, view.count);
    const auto id = device.readAll<uint32_t>(*view.id, view.slots);
    std::vector<vec4> all(view.slots);
    for (size_t k = 0; k < x.size(); ++k) all[id[k]] = x[k];
    return all;
}

class SleepOf : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Methods, SleepOf, testing::Values("dfsph", "pbf", "wcsph"), [](const auto& of) { return std::string(of.param); });

TEST_P(SleepOf, APoolComesToRestWhereItWouldWithoutSleepAndThenStaysBitForBit) {
    auto device = cpu();
    auto world = makeWorld(*device, pool(GetParam(), true, vec3(0.24F, 0.2F, 0.24F), 0.2F)),
         awake = makeWorld(*device, pool(GetParam(), false, vec3(0.24F, 0.2F, 0.24F), 0.2F));
    ASSERT_TRUE(world && awake);
    const int frames = settle(*world);
    ASSERT_LT(frames, 600) << world->stats().asleep << " of " << world->stats().particles << " sleep after ten seconds";
    ASSERT_GT(frames, 20) << "it is not at rest at the start";
    run(*awake, frames);
    const FluidStats f = world->stats();
    EXPECT_EQ(f.particles, awake->stats().particles);
    EXPECT_EQ(f.lost, 0U);
    EXPECT_EQ(f.kinetic, 0);
    EXPECT_NEAR(f.centreOfMass[1], awake->stats().centreOfMass[1], 0.01 * kSpacing);
    EXPECT_NEAR(f.avgCompression, awake->stats().avgCompression, 0.1 * awake->stats().avgCompression + 1.0e-4);
    const std::vector<vec4> before = byId(*world);
    run(*world, 30);
    EXPECT_EQ(before, byId(*world));
    EXPECT_EQ(world->stats().stepped, f.stepped) << "nothing was stepped";
    EXPECT_NEAR(world->time(), (frames + 30) * kFrame, 1.0e-9);
}

TEST_P(SleepOf, WhatFloatsMovesAsWithoutSleep) {
    auto device = cpu();
    const vec3 size(0.36F, 0.16F, 0.36F);
    Solids solids;
    solids.bodies.resize(1);
    solids.bodies[0].shape = sphereShape(0.04F, 300, kSpacing);
    solids.bodies[0].state.pose.position = vec3(0.18F, 0.28F, 0.18F);
    auto world = makeWorld(*device, pool(GetParam(), true, size), solids),
         awake = makeWorld(*device, pool(GetParam(), false, size), solids);
    ASSERT_TRUE(world && awake);
    double apart = 0, deepest = 1;
    const int frames = std::string(GetParam()) == "wcsph" ? 180 : 360;  // the others are calm later
    for (int k = 0; k < frames; ++k) {
        run(*world, 1);
        run(*awake, 1);
        const vec3 a = world->bodies()[0].pose.position, b = awake->bodies()[0].pose.position;
        apart = std::max(apart, double{std::abs(a.y - b.y)});
        deepest = std::min(deepest, double{b.y});
    }
    EXPECT_LT(apart, 0.01 * (0.28 - deepest)) << "of the height of its fall";
    EXPECT_LT(world->stats().stepped, 0.95 * awake->stats().stepped) << "some of the water slept";
}

TEST_P(SleepOf, ASavedStateContinuesBitForBit) {
    auto device = cpu();
    const vec3 size(0.4F, 0.16F, 0.4F);
    Solids solids;
    solids.bodies.resize(1);
    solids.bodies[0].shape = sphereShape(0.04F, 300, kSpacing);
    solids.bodies[0].state.pose.position = vec3(0.12F, 0.3F, 0.12F);
    const FluidParams p = pool(GetParam(), true, size);
    auto whole = makeWorld(*device, p, solids), second = makeWorld(*device, p, solids);
    ASSERT_TRUE(whole && second);
    int k = 0;
    // Until a part of it sleeps.
    for (; k < 400 && (whole->stats().asleep < 100 || whole->stats().asleep > whole->stats().particles - 100); ++k) run(*whole, 1);
    ASSERT_LT(k, 400);
    WorldState state;
    whole->save(state);
    const Status back = second->restore(state);
    ASSERT_TRUE(back) << back.error().message;
    run(*whole, 40);
    run(*second, 40);
    EXPECT_EQ(byId(*whole), byId(*second));
    EXPECT_EQ(byId(*whole, true), byId(*second, true));
    EXPECT_EQ(whole->bodies()[0].pose.position, second->bodies()[0].pose.position);
    EXPECT_EQ(whole->stats().asleep, second->stats().asleep);
}

TEST_P(SleepOf, OffIsWhatItIsWithBoundsThatNothingMeets) {
    auto device = cpu();
    FluidParams never = pool(GetParam());
    never.sleep.speed = 0;
    auto world = makeWorld(*device, never), off = makeWorld(*device, pool(GetParam(), false));
    ASSERT_TRUE(world && off);
    run(*world, 30);
    run(*off, 30);
    EXPECT_EQ(byId(*world), byId(*off));
    EXPECT_EQ(world->stats().asleep, 0U);
}

// What is drawn beside sleeping water is shaped by it: each share of neighbours is that which the places alone give.
TEST_P(SleepOf, EllipsoidsHaveTheirNeighboursThatSleep) {
    auto device = cpu();
    FluidParams p = pool(GetParam(), true, vec3(0.4F, 0.16F, 0.4F));
    p.ellipsoids = true;
    Solids solids;
    solids.bodies.resize(1);
    solids.bodies[0].shape = sphereShape(0.04F, 300, kSpacing);
    solids.bodies[0].state.pose.position = vec3(0.12F, 0.3F, 0.12F);
    auto world = makeWorld(*device, p, solids);
    ASSERT_TRUE(world);
    const auto partly = [](const FluidStats& f) { return f.asleep > f.particles / 8 && f.asleep < 7 * (f.particles / 8); };
    int k = 0;
    for (; k < 400 && !partly(world->stats()); ++k) run(*world, 1);
    ASSERT_LT(k, 400);
    const ParticleView view = world->particles();
    const auto id = device->readAll<uint32_t>(*view.id, view.slots);
    const auto at = device->readAll<vec4>(*view.position, view.slots), centre = device->readAll<vec4>(*view.ellipsoids[0], view.slots);
    std::vector<vec4> places(view.count);
    std::vector<float> share(view.count);
    for (size_t n = 0; n < id.size(); ++n)
        if (id[n] < view.count) {
            places[id[n]] = at[n];
            share[id[n]] = centre[n].w;
        }
    const auto alone = ellipsoidsOf(*device, places, kSpacing);
    ASSERT_TRUE(alone);
    float furthest = 0;
    for (size_t n = 0; n < places.size(); ++n) furthest = std::max(furthest, std::abs(share[n] - (*alone)[0][n].w));
    EXPECT_LT(furthest, 0.1F) << "without the sleeping ones it is half";
}

// What wakes a pool. `start` may change the world before it is made, `cause` acts on it when it sleeps.
struct Cause {
    const char* name;
    std::function<void(FluidParams&, Solids&, Sources&)> start;
    std::function<void(FluidWorld&, FluidInputs&)> cause;
};

// A ball above the pool that stays where it is until it is let go.
struct Held {
    bool released = false;
    BodyHost host() {
        return {.self = this,
                .advance =
                    [](void* self, std::span<const BodyLoad>, const vec3&, double seconds, std::span<BodyState> states) {
                        if (!static_cast<Held*>(self)->released) return;
                        states[0].velocity = vec3(0, -0.5F, 0);
                        states[0].pose.position.y -= static_cast<float>(0.5 * seconds);
                    },
                .reset = [](void*, std::span<const BodyState>) {},
                .remembersNothing = true};
    }
};

class Wakes : public testing::TestWithParam<const char*> {
  protected:
    // Lets a pool fall asleep, runs it on for a quarter of a second in which nothing happens, and then for one second with the cause.
    void wakes(const std::function<void(FluidParams&, Solids&, Sources&)>& start,
               const std::function<void(FluidWorld&, FluidInputs&)>& cause) {
        auto device = cpu();
        FluidParams p = pool(GetParam());
        Solids solids;
        Sources sources;
        if (start) start(p, solids, sources);
        auto made = FluidWorld::create(*device, p, solids, {}, sources);
        ASSERT_TRUE(made) << made.error().message;
        FluidWorld& world = **made;
        ASSERT_LT(settle(world), 600);
        run(world, 15);
        ASSERT_EQ(world.stats().asleep, world.stats().particles);
        uint32_t fewest = world.stats().asleep;
        const std::vector<vec4> before = byId(world);
        FluidInputs inputs;
        for (int k = 0; k < 60; ++k) {
            if (cause) cause(world, inputs);
            world.step(inputs, kFrame);
            fewest = std::min(fewest, world.stats().asleep);
        }
        EXPECT_LT(fewest, world.stats().particles / 2);
        EXPECT_EQ(world.stats().lost, 0U);
        const std::vector<vec4> after = byId(world);
        float furthest = 0;
        for (size_t k = 0; k < before.size(); ++k)
            if (before[k].w >= 0 && after[k].w >= 0) furthest = std::max(furthest, glm::length(vec3(after[k] - before[k])));
        EXPECT_GT(furthest, 0.2F * kSpacing) << "the water moves";
    }
};
INSTANTIATE_TEST_SUITE_P(Methods, Wakes, testing::Values("dfsph", "pbf"), [](const auto& of) { return std::string(of.param); });

TEST_P(Wakes, ByADryVolumeThatComes) {
    Sources dry;
    int frame = 0;
    wakes(
        [&](FluidParams& p, Solids&, Sources& sources) {
            const vec3 size = p.blocks[0].max;
            dry.dry = {{.position = vec3(0.5F * size.x, 1.7F * size.y, 0.5F * size.z), .size = 0.4F * size}};
            sources = dry;
        },
        [&](FluidWorld& world, FluidInputs&) {
            if (++frame == 2) EXPECT_EQ(world.stats().asleep, world.stats().particles) << "volumes that are set again wake none";
            if (frame > 1) dry.dry[0].position.y -= 0.02F * dry.dry[0].size.y;
            ASSERT_TRUE(world.setSources(dry));
            const vec3 low = dry.dry[0].position - 0.499F * dry.dry[0].size, high = dry.dry[0].position + 0.499F * dry.dry[0].size;
            if (frame < 3) return;
            // The volume of the frame before, less the way to this one.
            for (const vec4& x : byId(world))
                EXPECT_FALSE(x.w >= 0 && glm::all(glm::greaterThan(vec3(x), low + 0.03F * dry.dry[0].size)) &&
                             glm::all(glm::lessThan(vec3(x), high)))
                    << "frame " << frame;
        });
}

TEST_P(Wakes, ByGravityThatTurns) {
    wakes({}, [](FluidWorld&, FluidInputs& in) { in.gravity = vec3(3, -9.3F, 0); });
}

TEST_P(Wakes, ByAParameter) {
    wakes({}, [](FluidWorld& world, FluidInputs&) {
        FluidParams p = world.params();
        p.gravity = vec3(0, -9.3F, 3);
        ASSERT_TRUE(world.setParams(p));
    });
}

TEST_P(Wakes, ByABodyThatFallsIn) {
    Held held;
    wakes(
        [&](FluidParams&, Solids& solids, Sources&) {
            solids.bodies.resize(1);
            solids.bodies[0].shape = sphereShape(0.05F, 300, kSpacing);
            solids.bodies[0].state.pose.position = vec3(0.12F, 0.33F, 0.12F);
            solids.bodyHost = held.host();
        },
        [&](FluidWorld&, FluidInputs&) { held.released = true; });
}

TEST_P(Wakes, ByABodyThatIsAdded) {
    Body block;
    block.shape = boxShape(vec3(0.08F), 0, kSpacing);
    block.state.pose.position = vec3(0.12F, 0.1F, 0.12F);
    wakes([](FluidParams& p, Solids&, Sources&) { p.maxBodySamples = 200; },
          [&](FluidWorld& world, FluidInputs&) {
              if (world.bodies().empty()) EXPECT_TRUE(world.addBody(block));
          });
}

TEST_P(Wakes, ByAWallThatMoves) {
    const VoxelField field = test::baked(test::makeBox(vec3(-0.05F), vec3(0.05F)), 0.01F, kSpacing);
    std::vector<Pose> poses(1);
    poses[0].position = vec3(0.12F, 0.33F, 0.12F);
    wakes(
        [&](FluidParams&, Solids& solids, Sources&) {
            solids.rigid = {{&field, poses[0]}};
        },
        [&](FluidWorld&, FluidInputs& in) {
            poses[0].position.y = std::max(poses[0].position.y - 0.01F, 0.16F);
            in.poses = poses;
        });
}

TEST_P(Wakes, ByAnEmitter) {
    wakes(
        [](FluidParams&, Solids&, Sources& sources) {
            sources.emitters.resize(1);
            EmitterParams& e = sources.emitters[0].params;
            e.litresPerSecond = 0.0F;
            e.position = vec3(0.12F, 0.36F, 0.12F);
            e.radius = 0.03F;
        },
        [](FluidWorld& world, FluidInputs&) {
            Sources on;
            on.emitters.resize(1);
            EmitterParams& e = on.emitters[0].params;
            e.litresPerSecond = 1;
            e.position = vec3(0.12F, 0.36F, 0.12F);
            e.radius = 0.03F;
            ASSERT_TRUE(world.setSources(on));
        });
}

TEST_P(Wakes, ByASinkThatOpens) {
    Sources open;
    open.sinks.resize(1);
    open.sinks[0].position = vec3(0.12F, -1, 0.12F);  // outside
    open.sinks[0].size = vec3(0.1F);
    wakes([&](FluidParams&, Solids&, Sources& sources) { sources = open; },
          [&](FluidWorld& world, FluidInputs&) {
              open.sinks[0].position.y = 0;
              ASSERT_TRUE(world.setSources(open));
          });
}

TEST_P(Wakes, ByWaterThatAHostDeposits) {
    int frame = 0;
    wakes([](FluidParams&, Solids&, Sources& sources) { sources.expectedDeposit = 1.0e-3; },
          [&](FluidWorld& world, FluidInputs&) {
              if (++frame < 40) world.deposit(vec3(0.12F, 0.3F, 0.12F), vec3(0, -1, 0), 4.0e-5);
          });
}

TEST_P(Wakes, ByWaterThatAHostTakes) {
    wakes([](FluidParams&, Solids&, Sources& sources) { sources.expectedDeposit = 1.0e-3; },
          [](FluidWorld& world, FluidInputs&) {
              const std::vector<WorldParticle> there = world.within({vec3(0.08F, 0.0F, 0.08F), vec3(0.16F, 0.1F, 0.16F)});
              std::vector<uint32_t> slots;
              slots.reserve(there.size());
              for (const WorldParticle& p : there) slots.push_back(p.slot);
              world.withdraw(slots);
          });
}

// One that creeps more slowly than the bound on speed: the water gives way all the same.
TEST(Sleep, EndsWhereABodyIsRemoved) {
    auto device = cpu();
    const vec3 centre(0.12F, 0.1F, 0.12F), half(0.04F);
    Body block;
    block.shape = boxShape(2.0F * half, 0, kSpacing);
    block.state.pose.position = centre;
    auto world = makeWorld(*device, pool("dfsph"), {.bodies = {block}});
    ASSERT_LT(settle(*world), 600);
    ASSERT_TRUE(world->removeBody(0));
    run(*world, 20);
    EXPECT_LT(world->stats().asleep, world->stats().particles / 2);
    int inside = 0;
    for (const vec4& x : byId(*world)) inside += x.w >= 0 && glm::all(glm::lessThan(glm::abs(vec3(x) - centre), half)) ? 1 : 0;
    EXPECT_GT(inside, 32) << "of 64 that there is room for";
}

TEST_P(Wakes, ByABodyThatCreeps) {
    auto device = cpu();
    Solids solids;
    solids.bodies.resize(1);
    const BodyShape ball = sphereShape(0.05F, 300, kSpacing);
    solids.bodies[0].shape = ball;
    solids.bodies[0].state.pose.position = vec3(0.12F, 0.26F, 0.12F);
    bool released = false;
    solids.bodyHost = {.self = &released,
                       .advance =
                           [](void* self, std::span<const BodyLoad>, const vec3&, double seconds, std::span<BodyState> states) {
                               states[0].velocity = vec3(0, *static_cast<bool*>(self) ? -0.008F : 0.0F, 0);
                               states[0].pose.position += static_cast<float>(seconds) * states[0].velocity;
                           },
                       .reset = [](void*, std::span<const BodyState>) {},
                       .remembersNothing = true};
    auto world = makeWorld(*device, pool(GetParam()), solids);
    ASSERT_TRUE(world);
    ASSERT_LT(settle(*world), 600);
    released = true;
    run(*world, 360);
    const Pose at = world->bodies()[0].pose;
    float nearest = 1;
    for (const vec4& x : byId(*world))
        if (x.w >= 0) nearest = std::min(nearest, ball.distance(at.toOwn(vec3(x))));
    EXPECT_GT(nearest, 0.1F * kSpacing) << "no particle is in it; without sleep 0.18 and 0.19";
    EXPECT_LT(world->stats().maxCompression, 0.06);
}

// A host that calls withdraw() in every frame, without particles, does not keep the water awake.
TEST(Sleep, WaterThatNobodyTakesSleeps) {
    auto device = cpu();
    auto made = FluidWorld::create(*device, pool("dfsph"), {}, {}, {.expectedDeposit = 1.0e-3});
    ASSERT_TRUE(made) << made.error().message;
    int k = 0;
    for (; k < 600 && (*made)->stats().asleep < (*made)->stats().particles; ++k) {
        run(**made, 1);
        (*made)->withdraw({});
    }
    EXPECT_LT(k, 600);
}

// What is taken out of sleeping water wakes its surroundings alone.
TEST(Sleep, WaterThatIsTakenWakesWhatIsAroundIt) {
    auto device = cpu();
    auto made = FluidWorld::create(*device, pool("dfsph", true, vec3(1.2F, 0.12F, 0.12F)), {}, {}, {.expectedDeposit = 1.0e-3});
    ASSERT_TRUE(made) << made.error().message;
    FluidWorld& world = **made;
    ASSERT_LT(settle(world), 600);
    const std::vector<WorldParticle> there = world.within({vec3(0.0F, 0.1F, 0.08F), vec3(0.02F, 0.12F, 0.12F)});
    ASSERT_FALSE(there.empty());
    const std::vector<uint32_t> slots = {there[0].slot};
    world.withdraw(slots);
    uint32_t fewest = world.stats().particles;
    for (int k = 0; k < 5; ++k) {
        run(world, 1);
        fewest = std::min(fewest, world.stats().asleep);
    }
    EXPECT_LT(fewest, world.stats().particles);
    EXPECT_GT(fewest, world.stats().particles / 3);
}

// Tension moves particles aside after the solve, in buffers that sleeping particles are in, too.
TEST(Sleep, WaterUnderTensionSleepsOn) {
    auto device = cpu();
    FluidParams p = pool("dfsph");
    p.dfsph.negativePressure = true;
    auto world = makeWorld(*device, p);
    ASSERT_TRUE(world);
    ASSERT_LT(settle(*world), 600);
    const std::vector<vec4> before = byId(*world);
    run(*world, 60);
    EXPECT_EQ(world->stats().asleep, world->stats().particles);
    EXPECT_EQ(before, byId(*world));
    EXPECT_TRUE(world->stats().limited.empty());
    ASSERT_TRUE(world->setParams(p)) << "no change, so that nothing wakes";
    FluidInputs tilt;
    tilt.gravity = vec3(2, -9.6F, 0);
    for (int k = 0; k < 30; ++k) world->step(tilt, kFrame);
    EXPECT_EQ(world->stats().asleep, 0U);
    EXPECT_EQ(world->stats().lost, 0U);
}

TEST(Sleep, WithoutGravityNothingSleeps) {
    auto device = cpu();
    FluidParams p = pool("dfsph");
    p.gravity = vec3(0.0F);
    auto world = makeWorld(*device, p);
    ASSERT_TRUE(world);
    run(*world, 60);
    EXPECT_EQ(world->stats().asleep, 0U);
}

TEST(Sleep, AForceThatReadsMoreOfItsNeighboursKeepsWaterAwakeAndIsNamed) {
    auto device = cpu();
    FluidParams p = pool("dfsph");
    p.forces.tension = 0.07F;
    auto world = makeWorld(*device, p);
    ASSERT_TRUE(world);
    run(*world, 90);
    EXPECT_EQ(world->stats().asleep, 0U);
    ASSERT_EQ(world->stats().limited.size(), 1U);
    EXPECT_NE(world->stats().limited[0].find("'tension'"), std::string::npos) << world->stats().limited[0];
}

}  // namespace
}  // namespace rivulet::sleep_test
