// Time: frames that are too long, too slow or at another rate than the steps; pictures between two states; worlds far from the origin.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "engine/compute/device_cpu.h"
#include "fluid/sim/world/cpu_kernels.h"
#include "fluid/sim/world/fluid_world.h"
#include "fluid/sim/world/frame_stepper.h"
#include "tests/physics/worlds.h"
#include "tests/unit/voxel_test_meshes.h"

namespace rivulet::sim_time_test {
namespace {

FluidParams column(const char* method) {
    FluidParams p;
    p.method = method;
    p.spacing = 0.05F;
    p.blocks = {{vec3(0.0F), vec3(0.4F, 0.6F, 0.4F), vec3(0.0F)}};
    return p;
}

std::vector<vec4> byId(FluidWorld& world, const Buffer& buffer) {
    const uint32_t n = world.particles().count;
    const std::vector<vec4> values = world.device().readAll<vec4>(buffer, n);
    const std::vector<uint32_t> id = world.device().readAll<uint32_t>(*world.particles().id, n);
    std::vector<vec4> sorted(n);
    for (uint32_t i = 0; i < n; ++i) sorted[id[i]] = values[i];
    return sorted;
}

size_t saying(const FluidWorld& world, const char* words) {
    const auto& all = world.stats().limited;
    return static_cast<size_t>(
        std::count_if(all.begin(), all.end(), [&](const std::string& s) { return s.find(words) != std::string::npos; }));
}

class Time : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Methods, Time, testing::Values("wcsph", "pbf", "dfsph"), [](const auto& row) { return std::string(row.param); });

// 250 ms after 4 ms frames: steps are at most as long as in a run of 4 ms frames, except for the speed of the fall; no particle is lost or
// moves further than the fastest of that run could; and all requested time is accounted for.
TEST_P(Time, ALongFrameIsNotOneLargeStep) {
    auto device = cpu();
    const FluidParams p = column(GetParam());
    auto world = makeWorld(*device, p), steady = makeWorld(*device, p);
    for (int k = 0; k < 10; ++k) world->step({.gravity = p.gravity}, 0.004);
    for (int k = 0; k < 35; ++k) steady->step({.gravity = p.gravity}, 0.004);
    const std::vector<vec4> before = byId(*world, *world->particles().position);
    world->step({.gravity = p.gravity}, 0.25);
    const std::vector<vec4> after = byId(*world, *world->particles().position);
    EXPECT_NEAR(world->time(), 0.04 + 0.1, 1e-8);
    EXPECT_NEAR(world->dropped(), 0.15, 1e-8);
    EXPECT_NEAR(steady->time(), 0.14, 1e-12);
    EXPECT_EQ(saying(*world, "longestFrame"), 1U);
    EXPECT_EQ(world->stats().lost, 0U);
    EXPECT_LE(world->stats().dtMax, 1.0 / 60 + 1e-8);
    EXPECT_GE(world->lastSubsteps(), 6);
    double furthest = 0;
    for (size_t i = 0; i < before.size(); ++i) furthest = std::max(furthest, double{glm::length(vec3(after[i] - before[i]))});
    const double fall = 9.81 * (0.04 * 0.1 + 0.5 * 0.1 * 0.1);
    EXPECT_LT(furthest, 4 * fall) << "no farther than pressure and gravity throw it in a tenth of a second";
    EXPECT_GT(furthest, 0.25 * fall);
    // After the spike the simulated time equals that of a steady run.
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(world->stats().centreOfMass[axis], steady->stats().centreOfMass[axis], 0.01);
    EXPECT_NEAR(world->stats().kinetic, steady->stats().kinetic, 0.15 * steady->stats().kinetic);

    // After a breakpoint it continues; reported once.
    world->step({.gravity = p.gravity}, 10);
    EXPECT_NEAR(world->time() + world->dropped(), 0.04 + 0.25 + 10, 1e-9);
    EXPECT_NEAR(world->time(), 0.24, 1e-8);
    EXPECT_EQ(saying(*world, "longestFrame"), 1U);
}

// A budget that cannot be met: one substep per frame, slower simulated time, one notice; without the budget it recovers.
TEST_P(Time, ABudgetSlowsTimeAndNotTheProgram) {
    auto device = cpu();
    FluidParams p = column(GetParam());
    auto world = makeWorld(*device, p);
    for (int k = 0; k < 3; ++k) world->step({.gravity = p.gravity}, 1.0 / 60);
    EXPECT_NEAR(world->time(), 0.05, 1e-12);
    EXPECT_EQ(world->dropped(), 0);
    p.frameBudget = 1.0e-5F;
    ASSERT_TRUE(world->setParams(p));
    for (int k = 0; k < 5; ++k) {
        world->step({.gravity = p.gravity}, 0.1);
        EXPECT_EQ(world->lastSubsteps(), 1);
    }
    EXPECT_LT(world->time(), 0.05 + 5.0 / 60 + 1e-8);
    EXPECT_NEAR(world->time() + world->dropped(), 0.55, 1e-9);
    EXPECT_EQ(saying(*world, "frameBudget"), 1U);
    p.frameBudget = 0;
    ASSERT_TRUE(world->setParams(p));
    const double slowed = world->time();
    world->step({.gravity = p.gravity}, 0.1);
    EXPECT_NEAR(world->time() - slowed, 0.1, 1e-8);
    EXPECT_GE(world->lastSubsteps(), 6);
    EXPECT_EQ(world->stats().lost, 0U);
}

// The limit of one frame, as a window gives it, is not that of the next.
TEST_P(Time, AFrameMayHaveALimitOfItsOwn) {
    auto device = cpu();
    const FluidParams p = column(GetParam());
    auto world = makeWorld(*device, p);
    world->step({.mostMs = 1.0e-5}, 0.1);
    EXPECT_EQ(world->lastSubsteps(), 1);
    EXPECT_LT(world->time(), 0.02);
    EXPECT_EQ(saying(*world, "which take longer than"), 1U);
    const double slowed = world->time();
    world->step({.mostMs = 1.0e9}, 0.1);
    EXPECT_NEAR(world->time() - slowed, 0.1, 1e-8);
    world->step({}, 0.1);
    EXPECT_NEAR(world->time() - slowed, 0.2, 1e-8);
}

// A fixed step that takes longer than the limit ends early, and the next frame continues from there.
TEST_P(Time, AFixedStepMayHaveALimitOfItsOwn) {
    auto device = cpu();
    FluidParams p = column(GetParam());
    p.fixedStep = 0.0625F;
    auto world = makeWorld(*device, p);
    world->step({.mostMs = 1.0e-5}, 0.0625);
    EXPECT_EQ(world->lastSubsteps(), 1);
    EXPECT_LT(world->time(), 0.02);
    const double begun = world->time();
    world->step({}, 0.125);
    EXPECT_GT(world->lastSubsteps(), 2);
    EXPECT_GE(world->time() - begun, 0.0625 - 1e-8);
    EXPECT_EQ(world->stats().lost, 0U);
}

// Water so viscous that a frame needs hundreds of steps says so, once.
TEST_P(Time, WhatManyStepsCostIsSaid) {
    auto device = cpu();
    FluidParams p = column(GetParam());
    p.viscosity = 10;
    auto world = makeWorld(*device, p);
    for (int k = 0; k < 2; ++k) world->step({}, 1.0 / 60);
    const bool many = world->lastSubsteps() > 300;
    EXPECT_EQ(saying(*world, "the computation takes long"), many ? 1U : 0U);
    EXPECT_TRUE(many || std::string(GetParam()) != "wcsph") << world->lastSubsteps();
}

TEST_P(Time, WhatLimitsTheStepIsNamed) {
    auto device = cpu();
    FluidParams p = column(GetParam());
    p.maxSubsteps = 1;
    p.gravity = vec3(0, -1000, 0);
    auto world = makeWorld(*device, p);
    for (int k = 0; k < 2; ++k) world->step({.gravity = p.gravity}, 1.0 / 60);
    EXPECT_GE(saying(*world, "maxSubsteps"), 1U);
    const std::string method = GetParam();
    EXPECT_GE(saying(*world, method == "wcsph" ? "speed of sound" : method == "pbf" ? "weight that fluid.pbf.iterations" : "fastest"), 1U);
    EXPECT_NEAR(world->time() + world->dropped(), 2.0 / 60, 1e-12);
}

// Fixed steps with frames of any length: after the same time the bits are the same.
TEST_P(Time, FixedStepsDoNotDependOnFrames) {
    auto device = cpu();
    FluidParams p = column(GetParam());
    p.fixedStep = 0.01F;
    auto even = makeWorld(*device, p), uneven = makeWorld(*device, p);
    for (int k = 0; k < 12; ++k) even->step({.gravity = p.gravity}, double{p.fixedStep});
    double asked = 0;
    for (int k = 0; uneven->time() < 0.1195; ++k) {
        const double seconds = k % 3 == 0 ? 0.0037 : k % 3 == 1 ? 0.0131 : 0.0009;
        uneven->step({.gravity = p.gravity}, seconds);
        asked += seconds;
        EXPECT_NEAR(uneven->time() + uneven->pending(), asked, 1e-9);
        EXPECT_LT(uneven->pending(), double{p.fixedStep});
    }
    EXPECT_NEAR(even->time(), 0.12, 1e-6);
    EXPECT_EQ(even->time(), uneven->time());
    EXPECT_TRUE(byId(*even, *even->particles().position) == byId(*uneven, *uneven->particles().position));
    EXPECT_TRUE(byId(*even, *even->particles().velocity) == byId(*uneven, *uneven->particles().velocity));
}

// Uniform motion is drawn exactly, one step late: a straight line in time, to rounding. The order of particles changes every step, ids do
// not.
TEST(Drawn, UniformMotionIsDrawnExactly) {
    auto device = cpu();
    FluidParams p;
    p.method = "dfsph";
    p.spacing = 0.05F;
    p.gravity = vec3(0.0F);
    p.fixedStep = 0.02F;
    const vec3 v(0.5F, 0.3F, -0.4F);
    p.blocks = {{vec3(0.3F, 0.3F, 0.6F), vec3(0.35F, 0.35F, 0.65F), v}};  // one particle
    auto world = makeWorld(*device, p);
    ASSERT_EQ(world->particles().count, 1U);
    EXPECT_EQ(world->particles().drawn, world->particles().position) << "before the first step there is nothing between";
    const dvec3 from(byId(*world, *world->particles().position)[0]);
    double asked = 0;
    for (int k = 0; k < 40; ++k) {
        const double seconds = 0.004 + 0.003 * (k % 4);
        world->step({.gravity = p.gravity}, seconds);
        asked += seconds;
        if (world->time() == 0) continue;
        const dvec3 drawn(byId(*world, *world->particles().drawn)[0]);
        const dvec3 expected = from + dvec3(v) * (asked - double{p.fixedStep});
        EXPECT_LT(glm::length(drawn - expected), 1e-5) << asked << ": what floats of a position add up to in some hundred substeps";
    }
}

// A host draws 144 frames per second of a world with 100 steps per second: a falling particle is drawn on Galileo's parabola, one step
// late, and moves in every frame by the fall in that time.
TEST(Drawn, FallingParticlesAreDrawnOnAParabola) {
    auto device = cpu();
    FluidParams p;
    p.method = "dfsph";
    p.spacing = 0.05F;
    p.fixedStep = 0.01F;
    p.box.max = vec3(1.0F, 3.0F, 1.0F);
    p.blocks = {{vec3(0.4F, 2.5F, 0.4F), vec3(0.6F, 2.7F, 0.6F), vec3(0.0F)}};
    auto world = makeWorld(*device, p);
    const auto height = [&] {
        double sum = 0;
        const std::vector<vec4> drawn = byId(*world, *world->particles().drawn);
        for (const vec4& x : drawn) sum += double{x.y} / static_cast<double>(drawn.size());
        return sum;
    };
    const double g = 9.81, late = double{p.fixedStep}, frame = 1.0 / 144, top = height();
    double before = top;
    for (int k = 1; k <= 80; ++k) {
        world->step({.gravity = p.gravity}, frame);
        const double t = k * frame - late, now = height();
        if (world->time() > 0) {
            // Symplectic Euler is g t dt / 2 ahead; a chord is g dt^2 / 8 under its arc.
            const double dt = world->stats().dtMax;
            EXPECT_NEAR(now, top - 0.5 * g * t * t, 0.5 * g * t * dt + 0.125 * g * late * late + 1e-4) << k;
            if (t > late + frame) EXPECT_NEAR(before - now, g * (t - 0.5 * frame) * frame, g * late * frame + 1e-5) << k;
        }
        before = now;
    }
    EXPECT_LT(before, top - 1.3) << "half a second";
}

// Other motion is drawn between two states: on a straight line for each particle, at the elapsed share of the step.
TEST(Drawn, LiesBetweenTheLastTwoStates) {
    auto device = cpu();
    FluidParams p = column("wcsph");
    p.fixedStep = 0.01F;
    auto world = makeWorld(*device, p);
    for (int k = 0; k < 20; ++k) world->step({.gravity = p.gravity}, double{p.fixedStep});
    const std::vector<vec4> before = byId(*world, *world->particles().position);
    world->step({.gravity = p.gravity}, double{p.fixedStep});
    const std::vector<vec4> after = byId(*world, *world->particles().position);
    const std::vector<uint32_t> order = device->readAll<uint32_t>(*world->particles().id, world->particles().count);
    EXPECT_FALSE(std::is_sorted(order.begin(), order.end())) << "else the test would not see an order that is not followed";
    for (const double share : {0.3, 0.7}) {
        world->step({.gravity = p.gravity}, share * double{p.fixedStep} - world->pending());
        const std::vector<vec4> drawn = byId(*world, *world->particles().drawn);
        double worst = 0, moved = 0;
        for (size_t i = 0; i < drawn.size(); ++i) {
            const dvec3 expected = dvec3(before[i]) + share * (dvec3(after[i]) - dvec3(before[i]));
            worst = std::max(worst, glm::length(dvec3(drawn[i]) - expected));
            moved = std::max(moved, glm::length(dvec3(after[i]) - dvec3(before[i])));
        }
        EXPECT_GT(moved, 1e-3);
        EXPECT_LT(worst, 1e-6) << share;
    }
}

// A particle that wraps around in a periodic box is not interpolated across the image.
TEST(Drawn, NoParticleIsDrawnAcrossAPeriodicBox) {
    auto device = cpu();
    FluidParams p;
    p.method = "dfsph";
    p.spacing = 0.05F;
    p.gravity = vec3(0.0F);
    p.fixedStep = 0.02F;
    p.box.periodicX = true;
    p.blocks = {{vec3(0.9F, 0.5F, 0.5F), vec3(0.95F, 0.55F, 0.55F), vec3(1, 0, 0)}};
    auto world = makeWorld(*device, p);
    bool wrapped = false;
    for (int k = 0; k < 30; ++k) {
        world->step({.gravity = p.gravity}, 0.007);
        const double x = double{byId(*world, *world->particles().position)[0].x},
                     drawn = double{byId(*world, *world->particles().drawn)[0].x};
        EXPECT_LT(std::abs(x - drawn), 0.021);
        wrapped = wrapped || x < 0.3;
    }
    EXPECT_TRUE(wrapped);
}

// A moving wall stays in step with the water for any division into frames and steps.
TEST(Drawn, SolidsKeepStepWithFixedSteps) {
    auto device = cpu();
    FluidParams p = column("pbf");
    p.fixedStep = 0.01F;
    const test::Mesh plate = test::makeBox(vec3(-0.05F, -0.5F, -0.5F), vec3(0.05F, 0.5F, 0.5F));
    const MeshView view = plate.view();
    Result<VoxelField> field = bakeVoxelField(std::span(&view, 1), {.resolution = 40, .band = 0.1F, .padding = 0.1F});
    ASSERT_TRUE(field) << field.error().message;
    const Pose start{vec3(0.7F, 0.5F, 0.5F), quat(1, 0, 0, 0)};
    auto world = makeWorld(*device, p, {.rigid = {{&*field, start}}});
    const double speed = -1.5;
    double asked = 0;
    for (int k = 0; k < 30; ++k) {
        const double seconds = 0.003 + 0.002 * (k % 3);
        asked += seconds;
        Pose pose = start;
        pose.position.x += static_cast<float>(speed * asked);
        world->step({.gravity = p.gravity, .poses = std::span(&pose, 1)}, seconds);
        EXPECT_NEAR(double{world->poses()[0].position.x}, 0.7 + speed * world->time(), 1e-5);
        if (world->time() > 0) {
            EXPECT_NEAR(double{world->drawnPoses()[0].position.x}, 0.7 + speed * (asked - double{p.fixedStep}), 1e-5);
        }
    }
}

// On a GPU the budget is kept by times that arrive late.
TEST(FrameStepper, PlansFromWhatEarlierFramesTook) {
    FrameStepper stepper;
    (void)stepper.begin(1.0 / 60, 0, 8);
    EXPECT_TRUE(stepper.fitsPredicted(1000)) << "no times are recorded yet";
    for (int k = 0; k < 50; ++k) stepper.recordTime(k % 2 == 0 ? 24 : 0, 6);  // 24 ms that come every second frame: 2 ms a substep
    (void)stepper.begin(1.0 / 60, 0, 8);
    EXPECT_TRUE(stepper.fitsPredicted(2));
    EXPECT_TRUE(stepper.fitsPredicted(3));
    EXPECT_FALSE(stepper.fitsPredicted(4)) << "five of 2 ms are more than 8";
    for (int k = 0; k < 50; ++k) stepper.recordTime(3, 6);
    EXPECT_TRUE(stepper.fitsPredicted(14)) << "recovers";
    (void)stepper.begin(1.0 / 60, 0, 0);
    EXPECT_TRUE(stepper.fitsPredicted(100000)) << "no budget";
}

TEST(FrameStepper, WholeStepsThatWereNotMadeAreDropped) {
    FrameStepper stepper;
    EXPECT_EQ(stepper.begin(0.055, 0.01, 0).pieces, 5);
    EXPECT_NEAR(stepper.end(0.02), 0.03, 1e-12);
    EXPECT_NEAR(stepper.pending(), 0.005, 1e-12);
    EXPECT_NEAR(double{stepper.share()}, 0.5, 1e-6);
    EXPECT_EQ(stepper.begin(0.005, 0.01, 0).pieces, 1) << "rounding does not cost a step";
    EXPECT_NEAR(stepper.end(0.01), 0, 1e-12);
}

// ---- origin ----

TEST_P(Time, TenKilometresAwayAreTheSameBits) {
    auto device = cpu();
    FluidParams p = column(GetParam());
    auto here = makeWorld(*device, p);
    p.origin = dvec3(10000.1, -3.7, 12345.678901);
    auto there = makeWorld(*device, p);
    EXPECT_EQ(there->origin(), p.origin);
    for (int k = 0; k < 12; ++k)
        for (FluidWorld* world : {here.get(), there.get()}) world->step({.gravity = p.gravity}, 1.0 / 60);
    const std::vector<vec4> a = byId(*here, *here->particles().position), b = byId(*there, *there->particles().position);
    EXPECT_TRUE(a == b);
    EXPECT_TRUE(byId(*here, *here->particles().velocity) == byId(*there, *there->particles().velocity));
    for (const vec4& x : b) {
        EXPECT_NEAR(there->toHost(vec3(x)).x - 10000.1, double{x.x}, 1e-11);
        EXPECT_EQ(there->fromHost(there->toHost(vec3(x))), vec3(x));
    }
    ASSERT_TRUE(there->setParams(column(GetParam())));  // a scene that does not set the origin
    EXPECT_EQ(there->origin(), dvec3(0.0));
}

// What float alone would do: v dt below half a float's spacing at 10 km (0.98 mm) does not move anything.
TEST(Origin, FloatAloneLosesMotionFarAway) {
    auto device = cpu();
    const auto moved = [&](const vec3& low, const dvec3& origin) {
        FluidParams p;
        p.method = "dfsph";
        p.spacing = 0.05F;
        p.gravity = vec3(0.0F);
        p.origin = origin;
        p.box.min = low;
        p.box.max = low + 1.0F;
        p.blocks = {{low + 0.5F, low + 0.57F, vec3(0.1F, 0, 0)}};
        auto world = makeWorld(*device, p);
        EXPECT_EQ(world->particles().count, 1U);
        const double before = double{byId(*world, *world->particles().position)[0].x};
        for (int k = 0; k < 100; ++k) world->step({.gravity = p.gravity}, 0.004);  // 0.4 mm a step
        return double{byId(*world, *world->particles().position)[0].x} - before;
    };
    EXPECT_EQ(moved(vec3(10000, 0, 0), dvec3(0.0)), 0.0);
    EXPECT_NEAR(moved(vec3(0.0F), dvec3(10000, 0, 0)), 0.04, 1e-5);
}

}  // namespace
}  // namespace rivulet::sim_time_test
