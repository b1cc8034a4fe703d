// What the limits promise beyond the envelope's rows: steps as asked for without them, no crash whatever happens, and what was found to
// break with them on.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "engine/core/file.h"
#include "fluid/session/run_stats.h"
#include "fluid/validate/envelope_run.h"
#include "tests/physics/worlds.h"

namespace rivulet::limits_test {
namespace {

bool says(const FluidWorld& world, const char* words) {
    const auto& all = world.stats().limited;
    return std::any_of(all.begin(), all.end(), [&](const std::string& s) { return s.find(words) != std::string::npos; });
}

FluidParams column(const char* method, float spacing, float high) {
    FluidParams p;
    p.method = method;
    p.spacing = spacing;
    p.box.max = vec3(6 * spacing, 1.2F * high, 6 * spacing);
    p.blocks = {{vec3(0.0F), vec3(6 * spacing, high, 6 * spacing)}};
    return p;
}

class Limits : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Methods, Limits, testing::Values("wcsph", "wcsph_thesis", "pbf", "dfsph"),
                         [](const auto& row) { return std::string(row.param); });

// Off: one step a frame, of its length, however long; and no frame is cut short.
TEST_P(Limits, OffAFrameIsAStep) {
    auto device = cpu();
    FluidParams p = column(GetParam(), 0.05F, 0.3F);
    p.limits = false;
    auto world = makeWorld(*device, p);
    for (const double frame : {0.001, 0.05, 0.25}) {
        world->step({.gravity = p.gravity}, frame);
        EXPECT_EQ(world->lastSubsteps(), 1);
    }
    EXPECT_NEAR(world->time(), 0.301, 1e-12);
    EXPECT_EQ(world->dropped(), 0);
    EXPECT_EQ(world->stats().dtMax, 0.25);
    EXPECT_TRUE(says(*world, "fluid.limits is off"));
    p.limits = true;
    ASSERT_TRUE(world->setParams(p));
    world->step({.gravity = p.gravity}, 0.05);
    EXPECT_GT(world->lastSubsteps(), 2);
}

// No failure crashes: particles that become NaN are counted and frozen, and the number of particles stays.
TEST_P(Limits, OffNothingCrashesAndNanIsCounted) {
    for (const float frame : {0.02F, 0.25F}) {
        auto device = cpu();
        FluidParams p = column(GetParam(), 0.05F, 0.6F);
        p.limits = false;
        p.viscosity = 1;
        if (std::string_view(GetParam()) != "wcsph_thesis") p.forces.tension = 100;
        p.forces.vorticity = 100;
        auto world = makeWorld(*device, p);
        const uint32_t all = world->particles().count;
        for (int k = 0; k < 60; ++k) world->step({.gravity = 30.0F * p.gravity}, frame);
        const FluidStats& s = world->stats();
        EXPECT_EQ(s.particles, all);
        EXPECT_LE(s.nan, s.lost);
        size_t strange = 0;
        for (const vec4& x : readParticles(*world).position) strange += isFinite(vec3(x)) ? 0 : 1;
        EXPECT_EQ(strange, s.nan);
        if (s.lost > 0) EXPECT_TRUE(says(*world, "lost"));
    }
}

// None, one, and two in one place.
TEST_P(Limits, NoneOneAndTwoAtTheSamePoint) {
    for (const bool limits : {true, false})
        for (const int count : {0, 1, 2}) {
            auto device = cpu();
            FluidParams p;
            p.method = GetParam();
            p.limits = limits;
            const BlockParams one{vec3(0.5F), vec3(0.52F)};
            p.blocks.assign(static_cast<size_t>(count), one);
            auto world = makeWorld(*device, p);
            for (int frame = 0; frame < 30; ++frame) world->step({p.gravity}, 1.0 / 60);
            EXPECT_EQ(world->stats().particles, static_cast<uint32_t>(count));
            EXPECT_EQ(world->stats().lost, 0U);
            for (const vec4& x : readParticles(*world).position) EXPECT_TRUE(isFinite(vec3(x)));
        }
}

// Water that is woken again and again, by frames of any length, gains no energy and loses nothing: the envelope's criteria.
TEST(LimitsOfSleep, WakingAgainAndAgainAddsNoEnergy) {
    for (const char* method : {"wcsph", "pbf", "dfsph"})
        for (const double frame : {1.0 / 60, 0.1}) {
            auto device = cpu();
            FluidParams p = column(method, 0.05F, 0.3F);
            p.sleep = {.on = true, .speed = 0.1F, .after = 1};
            auto world = makeWorld(*device, p);
            world->step({}, frame);
            const FluidStats& s = world->stats();
            const double start = s.kinetic + s.potential;
            int wakings = 0;
            for (int k = 0; k < 120; ++k) {
                if (k % 20 == 19) wakings += s.asleep > 0 ? 1 : 0;
                // A push that is over before the water falls asleep again.
                const vec3 pull = k % 20 == 19 ? vec3(0.5F, -9.81F, 0) : p.gravity;
                world->step({.gravity = pull}, frame);
                EXPECT_LT(s.kinetic - static_cast<double>(s.particles) * 0.125 * -9.81 * s.centreOfMass[1], 1.1 * start)
                    << method << ", frame " << k;
                EXPECT_EQ(s.lost, 0U);
            }
            EXPECT_GE(wakings, 3) << method << ", frames of " << frame << " s";
        }
}

// PBF: a metre of water, with default settings, at any spacing. Its corrections support a limited weight: with steps of 4 ms a column of
// fifty layers boiled (18 m/s).
TEST(PbfWeight, AMetreOfWaterRestsAtAnySpacing) {
    for (const float spacing : {0.05F, 0.02F}) {
        auto device = cpu();
        const FluidParams p = column("pbf", spacing, 1);
        auto world = makeWorld(*device, p);
        double fastest = 0;
        for (int k = 0; k < 90; ++k) {
            world->step({.gravity = p.gravity}, 1.0 / 60);
            fastest = std::max(fastest, world->stats().maxSpeed);
        }
        EXPECT_LT(fastest, 2.5) << spacing;
        EXPECT_LT(world->stats().avgCompression, 0.04) << spacing;
        EXPECT_EQ(world->stats().lost, 0U);
        // No higher than it was: the centre of mass of what rests is half of it.
        EXPECT_LT(world->stats().centreOfMass[1], 0.5 + 0.25 * double{spacing}) << spacing;
    }
}

// A single correction that goes further than the whole way has no stable step. Speeds once grew as steps shrank, and steps shrank as speeds
// grew, to 1e19 m/s.
TEST(SpeedLimit, StopsGrowthThatStepsCannot) {
    auto device = cpu();
    FluidParams p = column("pbf", 0.05F, 1);
    p.pbf.iterations = 1;
    p.pbf.relaxation = 2.4F;  // a weight of 1.5
    auto world = makeWorld(*device, p);
    for (int k = 0; k < 40; ++k) world->step({.gravity = p.gravity}, 1.0 / 60);
    EXPECT_LT(world->stats().maxSpeed, 10 * 2 * std::sqrt(2 * 9.81 * 1.5));
    EXPECT_EQ(world->stats().lost, 0U);
    EXPECT_TRUE(says(*world, "no speed in this scene should be higher"));
    EXPECT_NEAR(world->time() + world->dropped(), 40.0 / 60, 1e-9);
}

// DFSPH: the first frame of a world without weight is as incompressible as the next. Blocks that flew into each other in it were squeezed
// by a tenth, and gained half of their energy.
TEST(DfsphFirstFrame, IsAsStiffAsTheNext) {
    auto device = cpu();
    FluidParams p;
    p.method = "dfsph";
    p.spacing = 0.05F;
    p.gravity = vec3(0.0F);
    p.fixedStep = 0.0458F;
    p.box.min = vec3(-1.5F, -1, -1);
    p.box.max = vec3(1.5F, 1, 1);
    p.blocks = {{vec3(-0.525F, -0.2F, -0.2F), vec3(-0.025F, 0.2F, 0.2F), vec3(2, 0, 0)},
                {vec3(0.025F, -0.2F, -0.2F), vec3(0.525F, 0.2F, 0.2F), vec3(-2, 0, 0)}};
    auto world = makeWorld(*device, p);
    const double start = 0.5 * 1280 * 0.125 * 4;
    for (int k = 0; k < 6; ++k) {
        world->step({.gravity = p.gravity}, double{p.fixedStep});
        EXPECT_LE(world->stats().kinetic, 1.001 * start);
        EXPECT_LT(world->stats().avgCompression, 0.005);
    }
}

// Nothing weighs anything, and the skin is strong.
FluidParams tense(const char* method, float half) {
    FluidParams p;
    p.method = method;
    p.spacing = 0.01F;
    p.gravity = vec3(0.0F);
    p.forces.tension = 10;
    p.box.min = vec3(-half);
    p.box.max = vec3(half);
    return p;
}

// Surface tension: a cube of liquid moves with no more than what its surface gives as it becomes a sphere's, 0.194 of it, and stays as
// dense as it was. With dfsph the eight in the middle of a lattice that is its own mirror image once fell into one place, and iterations
// diverged there and held them together.
TEST(TensionOfACube, MovesItAsMuchAsTheSphereItBecomesAllows) {
    for (const char* method : {"pbf", "dfsph"})
        for (const double dt : {0.0, 0.0005}) {
            auto device = cpu();
            FluidParams p = tense(method, 0.2F);
            p.fixedStep = static_cast<float>(dt);
            p.blocks = {{vec3(-0.05F), vec3(0.05F)}};
            auto world = makeWorld(*device, p);
            const double surface = 10 * 6 * 0.1 * 0.1;
            for (int k = 0; k < 15; ++k) {
                world->step({.gravity = p.gravity}, 1.0 / 60);
                EXPECT_LT(world->stats().kinetic, 0.194 * surface) << method << ", step " << dt << ", frame " << k;
                EXPECT_LT(world->stats().avgCompression, 0.01) << method << ", step " << dt << ", frame " << k;
            }
        }
}

// Surface tension: two that just come to see each other are not torn apart. A normal that means spray, 1e4 long, once met a neighbour's at
// the rim of its reach: 100 m/s.
TEST(TensionOfSpray, MeetsGently) {
    for (const char* method : {"pbf", "dfsph", "wcsph"}) {
        auto device = cpu();
        FluidParams p = tense(method, 0.1F);
        // One more than a support radius apart, which drift into it at a tenth of a metre a second.
        p.blocks = {{vec3(-0.02F, 0, 0), vec3(-0.01F, 0.01F, 0.01F), vec3(0.1F, 0, 0)}, {vec3(0.0002F, 0, 0), vec3(0.0102F, 0.01F, 0.01F)}};
        auto world = makeWorld(*device, p);
        ASSERT_EQ(world->particles().count, 2U);
        double fastest = 0;
        for (int k = 0; k < 20; ++k) {
            world->step({.gravity = p.gravity}, 0.001);
            fastest = std::max(fastest, world->stats().maxSpeed);
        }
        // They attract: what a pair's whole cohesion is worth is far below 2 m/s.
        EXPECT_LT(fastest, 2) << method;
    }
}

TEST(Warnings, OfABoxTooFarAwayAndOfPairs) {
    auto device = cpu();
    FluidParams p;
    p.method = "wcsph";
    p.kernel = "cubic_spline";
    p.supportSpacings = 2.5F;
    p.spacing = 0.05F;
    p.box.min = vec3(10000, 0, 0);
    p.box.max = vec3(10001, 1, 1);
    p.blocks = {{vec3(10000.4F, 0, 0.4F), vec3(10000.6F, 0.2F, 0.6F)}};
    auto world = makeWorld(*device, p);
    for (int k = 0; k < 3; ++k) world->step({.gravity = p.gravity}, 1.0 / 60);
    EXPECT_TRUE(says(*world, "fluid.origin"));
    EXPECT_TRUE(says(*world, "form pairs"));
    EXPECT_EQ(std::count_if(world->stats().limited.begin(), world->stats().limited.end(),
                            [](const std::string& s) { return s.find("fluid.origin") != std::string::npos; }),
              1)
        << "once";
    p.kernel = "wendland";
    p.box.min = vec3(0.0F);
    p.box.max = vec3(1.0F);
    p.blocks = {{vec3(0.4F, 0, 0.4F), vec3(0.6F, 0.2F, 0.6F)}};
    auto other = makeWorld(*device, p);
    other->step({.gravity = p.gravity}, 1.0 / 60);
    EXPECT_FALSE(says(*other, "fluid.origin"));
    EXPECT_FALSE(says(*other, "form pairs"));
}

// A body a hundred times as heavy as water, the other end of what the envelope's row sweeps.
// The ball may squirt a single drop from under itself: the middle one of three starts.
TEST(Coupling, AHeavyBallSinksAndNothingElseHappens) {
    auto device = cpu();
    const EnvelopeSettings settings{.device = device.get()};
    for (const char* method : {"wcsph", "pbf", "dfsph"}) {
        std::vector<double> fastest;
        for (const char* jitter : {"0.1", "0.2", "0.3"}) {
            const Result<Seen> seen = watch(settings, {.scene = "coupling",
                                                       .assignments = {std::string("fluid.method=") + method, "bodies.0.density=100000",
                                                                       std::string("fluid.blocks.0.jitter=") + jitter},
                                                       .limits = true,
                                                       .asFrames = true});
            ASSERT_TRUE(seen) << seen.error().message;
            EXPECT_FALSE(seen->failed) << method;
            fastest.push_back(seen->mostSpeed);
        }
        std::sort(fastest.begin(), fastest.end());
        EXPECT_LT(fastest[1], 5) << method;
    }
}

TEST(EnvelopePage, IsWrittenWithItsTableAndItsPicture) {
    const EnvelopeFinding failing{.row = "sound",
                                  .method = "wcsph",
                                  .what = "step, \"c0\" = 30 m/s",
                                  .unit = "s",
                                  .predicted = 0.001,
                                  .measured = 0.004,
                                  .reached = 0.004,
                                  .criterion = "energy",
                                  .limited = {0.008, true, true, true, 40, "a step was cut"}};
    EnvelopeFinding holding = failing;
    holding.row = "coupling";
    holding.unit = "";
    holding.measured = {};
    holding.predicted = 2;
    holding.reached = 100;
    const std::vector<EnvelopeFinding> all = {failing, holding};
    const std::string folder = (std::filesystem::path(testing::TempDir()) / "envelope").string();
    const Status wrote = writeEnvelope(folder, all, "a machine");
    ASSERT_TRUE(wrote) << wrote.error().message;
    const std::string csv = *readFile(folder + "/stability.csv"), page = *readFile(folder + "/stability.md");
    EXPECT_NE(csv.find("sound,wcsph,\"step, \"\"c0\"\" = 30 m/s\",s,0.001,0.004,0.004,4,"), std::string::npos) << csv;
    EXPECT_NE(csv.find(",2,,100,50,"), std::string::npos) << csv;
    EXPECT_NE(page.find("4 ms, 4 times the prediction"), std::string::npos) << page;
    EXPECT_NE(page.find("never, up to 100"), std::string::npos) << page;
    EXPECT_NE(page.find("1 of 2 sweeps failed, 0 of them below the predicted limit; with the limits on 2 of 2 hold."), std::string::npos);
    EXPECT_NE(readFile(folder + "/stability.svg")->find("<svg"), std::string::npos);
    std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace rivulet::limits_test
