// Budgets: the pick from a chart with a known answer, and the reaction to a run that exceeds its limits. No clock is read.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/core/json.h"
#include "fluid/session/budget.h"
#include "fluid/session/session.h"
#include "fluid/sim/world/cpu_kernels.h"

namespace rivulet::budget_test {
namespace {

// Two settings of pbf and two of dfsph, in a case where the fastest goes 1 m/s over spacings of 1 cm: 60 steps a second where it is not
// least.
std::vector<ChartRow> chart() {
    const auto row = [](const char* setting, double compression, double sweeps, double steps) {
        return ChartRow{.name = "dam_break",
                        .what = "front",
                        .setting = setting,
                        .spacing = 0.01,
                        .particles = 1000,
                        .error = 0.1,
                        .wallPerSecond = 1,
                        .sweepsPerSecond = sweeps,
                        .stepsPerSecond = steps,
                        .compression = compression,
                        .fastest = 1};
    };
    return {row("pbf 2", 0.02, 2400, 600), row("pbf", 0.008, 3000, 600), row("dfsph 1e-3", 0.002, 6000, 600),
            row("dfsph", 0.0003, 12000, 600)};
}
const std::vector<SweepCost> kCosts = {{"pbf", 50}, {"dfsph", 40}};
// 8,000 particles at a spacing of 1 cm, as fast as the case.
const SceneSize kSize{.particlesAt = 8000, .spacing = 0.01, .fastest = 1, .finest = 0.01};

BudgetParams budget(float ms, float error) { return {.frameMs = ms, .maxDensityError = error, .finest = 0}; }

TEST(Budget, CostsAreParticlesTimesSweeps) {
    // 50 a frame of 8,000 particles at 50 ns.
    EXPECT_NEAR(*frameCost(chart(), kCosts, kSize, *chartSettings().find("pbf"), 0.01), 50 * 8000 * 50e-6, 1e-9);
    // Twice as coarse: an eighth of the particles, half of the steps.
    EXPECT_NEAR(*frameCost(chart(), kCosts, kSize, *chartSettings().find("pbf"), 0.02), 50 * 8000 * 50e-6 / 16, 1e-9);
    // Never fewer steps than the setting's least, 4 of pbf.
    SceneSize slow = kSize;
    slow.fastest = 0.01;
    EXPECT_NEAR(*frameCost(chart(), kCosts, slow, *chartSettings().find("pbf"), 0.01), 4 * 5 * 8000 * 50e-6, 1e-9);
    EXPECT_FALSE(frameCost(chart(), kCosts, kSize, *chartSettings().find("wcsph"), 0.01)) << "it was not measured";
}

TEST(Budget, TheCheapestThatHoldsBothIsPicked) {
    // pbf 2 is cheaper than pbf, and squeezes water more than 1 %.
    const BudgetPick one = *pickSetting(chart(), kCosts, kSize, budget(100, 0.01F));
    EXPECT_STREQ(one.setting->name, "pbf");
    EXPECT_DOUBLE_EQ(one.spacing, 0.01);
    EXPECT_TRUE(one.holdsFrame && one.holdsError);
    EXPECT_STREQ(pickSetting(chart(), kCosts, kSize, budget(100, 0.05F))->setting->name, "pbf 2");
    EXPECT_STREQ(pickSetting(chart(), kCosts, kSize, budget(100, 0.003F))->setting->name, "dfsph 1e-3");
    // A tenth of the frame: coarser, and no coarser than it must be.
    const BudgetPick coarse = *pickSetting(chart(), kCosts, kSize, budget(2, 0.01F));
    EXPECT_STREQ(coarse.setting->name, "pbf");
    EXPECT_TRUE(coarse.holdsFrame);
    EXPECT_GT(coarse.spacing, 0.01);
    EXPECT_LE(coarse.frameMs, 2);
    EXPECT_GT(*frameCost(chart(), kCosts, kSize, *coarse.setting, coarse.spacing / 1.021), 0.85 * 2) << "one step finer would not hold";
    // Finer where there is room, if the scene allows it.
    SceneSize finer = kSize;
    finer.finest = 0.005;
    EXPECT_DOUBLE_EQ(pickSetting(chart(), kCosts, finer, budget(1000, 0.01F))->spacing, 0.005);
}

TEST(Budget, LimitsThatCannotBeHeldAreReported) {
    const BudgetPick strict = *pickSetting(chart(), kCosts, kSize, budget(100, 1e-5F));
    EXPECT_STREQ(strict.setting->name, "dfsph") << "comes nearest";
    EXPECT_FALSE(strict.holdsError);
    const BudgetPick tiny = *pickSetting(chart(), kCosts, kSize, budget(1e-4F, 0.01F));
    EXPECT_FALSE(tiny.holdsFrame);
    EXPECT_NEAR(tiny.particles, 500, 1);
    EXPECT_FALSE(pickSetting({}, kCosts, kSize, budget(16, 0.01F)));
}

struct Watched {
    Budget budget;
    Watched(float ms, float error) : budget({ms, error, 0}, chart(), kCosts, kSize, *pickSetting(chart(), kCosts, kSize, {ms, error, 0})) {}
    // A simulated second, in so many frames; what was said, all of it.
    std::string second(double ms, double error, int* changes = nullptr, int frames = 60) {
        std::string all, sentence;
        for (int k = 0; k < frames; ++k) {
            if (budget.frame(ms * 60 / frames, 1.0 / frames, error, sentence) && changes != nullptr) ++*changes;
            all += sentence;
        }
        return all;
    }
};

TEST(Budget, ARunThatHoldsIsLeftAlone) {
    Watched w(30, 0.01F);
    EXPECT_EQ(w.second(32.9, 0.0109), "") << "a tenth more holds it";
    EXPECT_EQ(w.second(32.9, 0.0109, nullptr, 144), "") << "however many frames a second has";
    EXPECT_NE(w.budget.report().find(": held"), std::string::npos) << w.budget.report();
}

TEST(Budget, ARunOfLessThanASecondIsJudgedByItsFrames) {
    Watched w(30, 0.01F);
    std::string sentence;
    for (int k = 0; k < 5; ++k) EXPECT_FALSE(w.budget.frame(50, 1.0 / 60, 0.001, sentence));
    EXPECT_NE(w.budget.report().find(": not held"), std::string::npos) << w.budget.report();
    EXPECT_EQ(w.budget.report().find("worst second"), std::string::npos) << w.budget.report();
}

// Where time slows down, a frame has not simulated a sixtieth.
TEST(Budget, SlowerTimeHoldsNothing) {
    Watched w(30, 0.01F);
    std::string sentence;
    for (int k = 0; k < 120; ++k) w.budget.frame(20, 1.0 / 120, 0.001, sentence);
    EXPECT_NE(w.budget.report().find(": not held"), std::string::npos) << w.budget.report();
}

TEST(Budget, ADensityErrorIsCorrectedWithinTheMethod) {
    Watched w(30, 0.05F);
    EXPECT_STREQ(w.budget.setting().name, "pbf 2");
    int changes = 0;
    const std::string said = w.second(10, 0.08, &changes);
    EXPECT_EQ(changes, 1);
    EXPECT_NE(said.find("pbf from now on"), std::string::npos) << said;
    EXPECT_EQ(w.budget.repicked(), 1);
    // That one misses the frame, and what was picked before has missed already: it says why, once. (50 / 25.5)^(1/4) coarser.
    const std::string why = w.second(50, 0.02, &changes);
    EXPECT_EQ(changes, 1);
    EXPECT_NE(why.find("budget.finest = 0.0118"), std::string::npos) << why;
    EXPECT_EQ(w.second(50, 0.02), "");
    EXPECT_NE(w.budget.report().find("not held"), std::string::npos);
    // Density alone: no spacing mends that.
    Watched off(30, 0.01F);
    EXPECT_NE(off.second(10, 0.08).find("smaller budget.maxDensityError"), std::string::npos);
}

TEST(Budget, ASettingSetsOnlyTheParamsThatSettingsName) {
    SceneFile scene;
    scene.fluid.pbf.iterations = 20;
    scene.fluid.pbf.tolerance = 0.01F;
    scene.fluid.pbf.relaxation = 0.9F;
    scene.fluid.cfl = 0.8F;
    applySetting(*chartSettings().find("pbf 3, short steps"), scene);
    EXPECT_EQ(scene.fluid.method, "pbf");
    EXPECT_EQ(scene.fluid.pbf.iterations, 3);
    EXPECT_EQ(scene.fluid.pbf.minSubsteps, 8);
    applySetting(*chartSettings().find("pbf"), scene);
    EXPECT_EQ(scene.fluid.pbf.minSubsteps, 4) << "nothing stays of the one before";
    EXPECT_EQ(scene.fluid.pbf.tolerance, 0);
    EXPECT_FLOAT_EQ(scene.fluid.pbf.relaxation, 0.9F);
    EXPECT_FLOAT_EQ(scene.fluid.cfl, FluidParams().cfl);
}

TEST(Budget, TheCostIsOfMaxParticlesAtMost) {
    SceneSize capped = kSize;
    capped.most = 4000;
    EXPECT_DOUBLE_EQ(capped.particles(0.01), 4000);
    EXPECT_DOUBLE_EQ(capped.particles(0.02), 1000);
    EXPECT_NEAR(*frameCost(chart(), kCosts, capped, *chartSettings().find("pbf"), 0.01), 50 * 4000 * 50e-6, 1e-9);
}

TEST(Budget, AFrameThatTakesTooLongGetsACheaperSetting) {
    Watched w(120, 0.001F);
    EXPECT_STREQ(w.budget.setting().name, "dfsph");
    // The cheaper one compresses 6.7 times as much by the chart: 0.07 %.
    int changes = 0;
    w.second(150, 0.0001, &changes);
    EXPECT_EQ(changes, 1);
    EXPECT_STREQ(w.budget.setting().name, "dfsph 1e-3");
}

TEST(Budget, ASceneGetsAMethodASpacingAndAReport) {
    const std::vector<CpuKernelRow> rows = cpuKernels();
    auto device = makeCpuDevice(rows);
    Result<SceneFile> scene = loadScene("dam_break", std::vector<std::string>{"budget.frameMs=1000", "budget.maxDensityError=0.02"});
    ASSERT_TRUE(scene);
    std::string said;
    Log log{[&](LogLevel, std::string_view text) { said += text; }};
    auto session = Session::create(*scene, *device, log);
    ASSERT_TRUE(session) << session.error().message;
    EXPECT_NE(said.find("budget of 1000 ms and 2 %"), std::string::npos) << said;
    ASSERT_TRUE((*session)->budget());
    const SceneFile& picked = (*session)->scene();
    EXPECT_EQ(picked.fluid.method, (*session)->budget()->setting().method);
    EXPECT_EQ(picked.fluid.method, (*session)->world().params().method);
    EXPECT_FLOAT_EQ(picked.fluid.spacing, 0.015625F) << "a second is enough for the scene's own";
    EXPECT_FLOAT_EQ(picked.budget.finest, 0.015625F);
    for (int k = 0; k < 61; ++k) (*session)->step(1.0 / 60, true);
    EXPECT_NE((*session)->budget()->report().find("measured over 1.02 s"), std::string::npos) << (*session)->budget()->report();
    // What a budget has picked, an edit does not take away.
    SceneFile edited = picked;
    edited.fluid.gravity = vec3(0, -5, 0);
    edited.fluid.dfsph.tolerance = 0.07F;
    edited.fluid.pbf.iterations = 40;
    (*session)->apply(edited);
    EXPECT_EQ((*session)->scene().fluid.gravity, vec3(0, -5, 0));
    EXPECT_NE((*session)->scene().fluid.pbf.iterations, 40);
    EXPECT_NE((*session)->scene().fluid.dfsph.tolerance, 0.07F);
    // Without one there is none.
    Result<SceneFile> plain = loadScene("dam_break", std::vector<std::string>{"fluid.spacing=0.05"});
    EXPECT_FALSE((*Session::create(*plain, *device, Log{}))->budget());
}

TEST(Budget, WorksWithAnyScene) {
    const std::vector<CpuKernelRow> rows = cpuKernels();
    auto device = makeCpuDevice(rows);
    const auto open = [&](std::vector<std::string> assignments, std::string& said) {
        Log log{[&said](LogLevel, std::string_view text) { said += text; }};
        Result<SceneFile> scene = loadScene("dam_break", assignments);
        EXPECT_TRUE(scene);
        return Session::create(*scene, *device, log);
    };
    std::string said;
    // Too fine for any machine: the budget picks what this one can.
    auto fine = open({"budget.frameMs=5", "fluid.spacing=1e-4"}, said);
    ASSERT_TRUE(fine) << fine.error().message;
    EXPECT_LT((*fine)->world().particles().count, 100000U);
    // A puddle far thinner than what a trial begins with.
    said.clear();
    auto thin = open({"budget.frameMs=50", "fluid.blocks.0.max=0.25,0.01,0.25", "fluid.spacing=0.005"}, said);
    ASSERT_TRUE(thin) << thin.error().message;
    EXPECT_GT((*thin)->world().particles().count, 0U) << said;
    // No water: nothing is picked, and that is said.
    said.clear();
    auto dry = open({"budget.frameMs=5", "fluid.blocks.0.max=0.001,0.001,0.001"}, said);
    ASSERT_TRUE(dry) << dry.error().message;
    EXPECT_FALSE((*dry)->budget());
    EXPECT_NE(said.find("is ignored"), std::string::npos) << said;
    // What every method refuses is refused in its sentence.
    EXPECT_FALSE(open({"budget.frameMs=5", "colliders.0.mesh=nowhere.obj"}, said));
    for (const char* wrong : {"budget.frameMs=-1", "budget.maxDensityError=0", "budget.frameMs=x", "budget.frame=3"})
        EXPECT_FALSE(loadScene("dam_break", std::vector<std::string>{wrong})) << wrong;
}

}  // namespace
}  // namespace rivulet::budget_test
