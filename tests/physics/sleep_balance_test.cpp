// Water that falls asleep, sleeps and is woken keeps its accounts: volume, energy and momentum.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <string>

#include "fluid/sim/solids/body_shapes.h"
#include "tests/physics/baked_mesh.h"
#include "tests/physics/loads.h"
#include "tests/physics/worlds.h"

namespace rivulet::sleep_balance_test {
namespace {

constexpr float kSpacing = 0.02F;
constexpr double kFrame = 1.0 / 60, kGravity = 9.81;
// Of its energy; wcsph has some in its pressures, which no figure counts.
constexpr double kGrowth = 5.0e-4;
const vec3 kSize(0.2F, 0.12F, 0.2F);   // m, of the water
const vec3 kAbove(0.1F, 0.22F, 0.1F);  // where the ball, the wall and the jet are

FluidParams pool(const std::string& method, bool sleeps) {
    FluidParams p;
    p.method = method;
    p.spacing = kSpacing;
    p.sleep.on = sleeps;
    if (method == "pbf") p.sleep.speed = 0.02F;  // it trembles
    p.box.max = vec3(kSize.x, 0.4F, kSize.z);
    p.blocks = {{.min = vec3(0.0F), .max = kSize}};
    return p;
}

// A ball that is held above the water until it is let go; then it falls and the water carries it.
struct Ball {
    float mass = 0;
    bool released = false;
    BodyHost host() {
        return {.self = this,
                .advance =
                    [](void* self, std::span<const BodyLoad> loads, const vec3& gravity, double seconds, std::span<BodyState> states) {
                        const Ball& ball = *static_cast<Ball*>(self);
                        if (!ball.released) return;
                        states[0].velocity += vec3((dvec3(gravity) + loads[0].force / double{ball.mass}) * seconds);
                        states[0].pose.position += states[0].velocity * static_cast<float>(seconds);
                    },
                .reset = [](void*, std::span<const BodyState>) {},
                .remembersNothing = true};
    }
    double energy(const FluidWorld& world) const {
        if (world.bodies().empty()) return 0;
        const BodyState& s = world.bodies()[0];
        return double{mass} * (0.5 * double{glm::dot(s.velocity, s.velocity)} + kGravity * double{s.pose.position.y});
    }
};

// A pool and the thing that wakes it: a ball, a wall, a jet, or nothing.
class Pool {
  public:
    Pool(const std::string& method, const std::string& cause, bool sleeps) : cause_(cause), device_(cpu()) {
        Solids solids;
        Sources sources;
        if (cause == "ball") {
            solids.bodies.resize(1);
            solids.bodies[0].shape = sphereShape(0.03F, 1500, kSpacing);
            solids.bodies[0].state.pose.position = kAbove;
            ball_.mass = solids.bodies[0].shape.mass;
            solids.bodyHost = ball_.host();
        } else if (cause == "wall") {
            box_ = test::baked(test::makeBox(vec3(-0.04F), vec3(0.04F)), 0.01F, kSpacing);
            poses_.resize(1);
            poses_[0].position = kAbove;
            solids.rigid = {{&box_, poses_[0]}};
        } else if (cause == "jet") {
            sources = {.emitters = {jet(0)}, .more = 1.0e-3};
        }
        auto made = FluidWorld::create(*device_, pool(method, sleeps), solids, {}, sources);
        EXPECT_TRUE(made) << made.error().message;
        if (made) world = std::move(*made);
    }
    static Emitter jet(float litresPerSecond) {
        Emitter e;
        e.params.litresPerSecond = litresPerSecond;
        e.params.position = kAbove;
        e.params.radius = 0.03F;
        return e;
    }
    void wake() {
        awake_ = true;
        ball_.released = true;
        if (cause_ == "jet") ASSERT_TRUE(world->setSources({.emitters = {jet(1)}}));
    }
    void frame() {
        FluidInputs inputs;
        if (cause_ == "wall" && awake_) poses_[0].position.y = std::max(poses_[0].position.y - 0.01F, kSize.y);
        if (cause_ == "wall") inputs.poses = poses_;
        world->step(inputs, kFrame);
    }
    // J, of the water and the ball.
    double energy() const { return world->stats().kinetic + world->stats().potential + ball_.energy(*world); }

  private:
    std::string cause_;
    bool awake_ = false;
    Ball ball_;
    VoxelField box_;
    std::vector<Pose> poses_;
    std::unique_ptr<CpuDevice> device_;

  public:
    std::unique_ptr<FluidWorld> world;  // uses those above
};

struct Case {
    const char *method, *cause;
};
// One cause for each method; all nine with RIVULET_SLEEP=full in the environment.
std::vector<Case> cases() {
    if (std::getenv("RIVULET_SLEEP") == nullptr) return {{"dfsph", "ball"}, {"pbf", "wall"}, {"wcsph", "jet"}};
    std::vector<Case> all;
    for (const char* method : {"dfsph", "pbf", "wcsph"})
        for (const char* cause : {"ball", "wall", "jet"}) all.push_back({method, cause});
    return all;
}

class SleepBalance : public testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Methods, SleepBalance, testing::ValuesIn(cases()),
                         [](const auto& of) { return std::string(of.param.method) + "_" + of.param.cause; });

// kg m/s over kg m/s: the momentum of water that is calm everywhere.
double calm(const Pool& pool) {
    const FluidParams& p = pool.world->params();
    return double{p.sleep.speed} * std::sqrt(kGravity * double{p.supportSpacings} * double{p.spacing});
}

void expectWhole(const FluidStats& f) {
    constexpr double kOne = double{kSpacing} * double{kSpacing} * double{kSpacing};
    EXPECT_NEAR(f.particles * kOne, f.emitted - f.drained - f.withdrawn, 1.0e-10);
    EXPECT_EQ(f.lost, 0U);
    EXPECT_LE(f.asleep, f.particles);
}

TEST_P(SleepBalance, HoldsWhileItFallsAsleepSleepsAndWakes) {
    const std::string cause = GetParam().cause;
    Pool pool(GetParam().method, cause, true), awake(GetParam().method, cause, false);
    ASSERT_TRUE(pool.world && awake.world);
    const FluidStats& f = pool.world->stats();
    pool.frame();
    awake.frame();
    const double start = pool.energy(), mass = 1000 * f.emitted;

    // It falls asleep: energy only falls, and no momentum goes where water stops.
    int frames = 0;
    double momentum = 0;
    for (; frames < 600 && f.asleep < f.particles; ++frames) {
        const uint32_t before = f.asleep;
        const double was = momentum;
        pool.frame();
        awake.frame();
        expectWhole(f);
        EXPECT_LE(pool.energy(), (1 + kGrowth) * start) << frames;
        momentum = glm::length(test::momentumOf(*pool.world));
        if (f.asleep > before) EXPECT_LT(was, mass * calm(pool)) << frames;
    }
    ASSERT_LT(frames, 600);

    // It sleeps.
    const double asleep = pool.energy();
    for (int k = 0; k < 15; ++k) {
        pool.frame();
        awake.frame();
        expectWhole(f);
        EXPECT_EQ(pool.energy(), asleep);
        EXPECT_EQ(test::momentumOf(*pool.world), dvec3(0.0));
    }

    // It wakes, and moves as water does that never slept.
    pool.wake();
    awake.wake();
    const double other = awake.energy(), emitted = f.emitted, time = pool.world->time();
    double most = 0, mostAwake = 0;
    uint32_t fewest = f.asleep;
    for (int k = 0; k < 60; ++k) {
        pool.frame();
        awake.frame();
        expectWhole(f);
        fewest = std::min(fewest, f.asleep);
        // Work is done by the jet alone: at most what its water has at the opening.
        const double brought = 1000 * (f.emitted - emitted) * (kGravity * double{kAbove.y} + 0.5 * 0.36 * 0.36);
        most = std::max(most, pool.energy() - asleep - brought);
        mostAwake = std::max(mostAwake, awake.energy() - other - brought);
    }
    EXPECT_LT(fewest, f.particles / 2);
    if (cause != "wall") EXPECT_LT(most, mostAwake + kGrowth * start) << "J";
    // After a second, as much was lost or gained, but for splashes that are never twice the same. Two pools at rest differ by a thousandth
    // of a spacing in height.
    const double change = pool.energy() - asleep, expected = awake.energy() - other;
    EXPECT_NEAR(change, expected, 0.1 * std::abs(expected) + kGrowth * start) << "J";
    if (cause != "jet") return;
    const double due = emitted + 1.0e-3 * (pool.world->time() - time);
    EXPECT_NEAR(f.emitted + f.backlog, due, 1.5 * std::pow(double{kSpacing}, 3));
    EXPECT_GT(f.emitted, emitted + 5.0e-4);
}

class SleepLoads : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Methods, SleepLoads, testing::Values("dfsph", "pbf", "wcsph"),
                         [](const auto& of) { return std::string(of.param); });

// Sleeping water gives walls no impulse: where loads on walls are measured it stays awake, and they are the change of momentum.
TEST_P(SleepLoads, OnWallsKeepWaterAwakeAndMissNothing) {
    auto device = cpu();
    FluidParams p = pool(GetParam(), true);
    p.sleep.speed = 0.5F;  // calm at once
    p.sleep.after = 0.5F;
    p.probes = test::probesOfAll({});
    auto world = makeWorld(*device, p);
    ASSERT_TRUE(world);
    EXPECT_LT(test::balanceOf(*world, 60).missing, 1.0e-4);
    EXPECT_EQ(world->stats().asleep, 0U);
    ASSERT_EQ(world->stats().limited.size(), 1U);
    EXPECT_NE(world->stats().limited[0].find("a probe measures the load on a wall"), std::string::npos) << world->stats().limited[0];
    p.probes.clear();
    ASSERT_TRUE(world->setParams(p));
    for (int k = 0; k < 60; ++k) world->step({}, kFrame);
    EXPECT_EQ(world->stats().asleep, world->stats().particles);
}

// The load on a body is that of the water around it, whether it sleeps or not: Archimedes, of a ball that stands still under water.
TEST(SleepLoad, OnABodyMeasureWaterThatSleeps) {
    double lift[2] = {0, 0};
    for (const bool sleeps : {true, false}) {
        auto device = cpu();
        FluidParams p = pool("dfsph", sleeps);
        p.probes = {{.name = "ball", .on = "body"}};
        Solids solids;
        solids.bodies.resize(1);
        solids.bodies[0].shape = sphereShape(0.03F, 0, kSpacing);
        solids.bodies[0].state.pose.position = vec3(0.1F, 0.06F, 0.1F);
        auto world = makeWorld(*device, p, solids);
        ASSERT_TRUE(world);
        for (int k = 0; k < 600 && world->stats().asleep < world->stats().particles && (sleeps || k < 120); ++k) world->step({}, kFrame);
        constexpr int kMean = 30;
        for (int k = 0; k < kMean; ++k) {
            world->step({}, kFrame);
            lift[sleeps ? 0 : 1] += world->stats().loads.probes[0].force.y / kMean;
        }
        if (sleeps) EXPECT_EQ(world->stats().asleep, world->stats().particles);
    }
    EXPECT_NEAR(lift[0], lift[1], 0.02 * lift[1]);
    EXPECT_NEAR(lift[0], kGravity * 1000 * 4 / 3 * 3.14159265 * std::pow(0.03, 3), 0.1 * lift[0]);
}

}  // namespace
}  // namespace rivulet::sleep_balance_test
