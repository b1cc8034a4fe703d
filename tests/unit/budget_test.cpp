// A budget: what is picked from a table whose answer is known, and what is done about a run that misses it. No clock is read.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/core/json.h"
#include "fluid/bridge/budget.h"
#include "fluid/bridge/session.h"
#include "fluid/sim/cpu_kernels.h"

namespace rivulet {
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
    EXPECT_FALSE(frameCost(chart(), kCosts, kSize, *chartSettings().find("wcsph"), 0.01)) << "nobody has measured it";
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
    EXPECT_GT(*frameCost(chart(), kCosts, kSize, *coarse.setting, coarse.spacing / 1.06), 0.85 * 2) << "one step finer would not hold";
    // Finer where there is room, if the scene allows it.
    SceneSize finer = kSize;
    finer.finest = 0.005;
    EXPECT_DOUBLE_EQ(pickSetting(chart(), kCosts, finer, budget(1000, 0.01F))->spacing, 0.005);
}

TEST(Budget, WhatCannotBeHeldIsSaid) {
    const BudgetPick strict = *pickSetting(chart(), kCosts, kSize, budget(100, 1e-5F));
    EXPECT_STREQ(strict.setting->name, "dfsph") << "comes nearest";
    EXPECT_FALSE(strict.holdsError);
    const BudgetPick tiny = *pickSetting(chart(), kCosts, kSize, budget(1e-4F, 0.01F));
    EXPECT_FALSE(tiny.holdsFrame);
    EXPECT_NEAR(tiny.particles, 500, 1);
    EXPECT_FALSE(pickSetting({}, kCosts, kSize, budget(16, 0.01F)));
}

struct Watched {
    SceneFile scene;
    Budget budget;
    explicit Watched(float ms, float error)
        : scene(sceneOf(ms, error)), budget(scene, chart(), kCosts, kSize, *pickSetting(chart(), kCosts, kSize, scene.budget)) {}
    static SceneFile sceneOf(float ms, float error) {
        SceneFile s;
        s.budget = {.frameMs = ms, .maxDensityError = error, .finest = 0};
        s.fluid.pbf.relaxation = 0.9F;
        return s;
    }
    // A second of frames; what was said, all of it.
    std::string second(double ms, double error, int* changes = nullptr) {
        std::string all, sentence;
        for (int k = 0; k < 60; ++k) {
            if (budget.frame(ms, error, sentence) && changes != nullptr) ++*changes;
            all += sentence;
        }
        return all;
    }
};

TEST(Budget, ARunThatHoldsIsLeftAlone) {
    Watched w(30, 0.01F);
    EXPECT_EQ(w.second(32.9, 0.0109), "") << "a tenth more holds it";
    EXPECT_NE(w.budget.report().find(": held"), std::string::npos) << w.budget.report();
}

TEST(Budget, DensityThatIsOffIsMendedWithinTheMethod) {
    Watched w(30, 0.05F);
    EXPECT_STREQ(w.budget.setting().name, "pbf 2");
    int changes = 0;
    const std::string said = w.second(10, 0.08, &changes);
    EXPECT_EQ(changes, 1);
    EXPECT_NE(said.find("pbf from now on"), std::string::npos) << said;
    w.budget.apply(w.scene);
    EXPECT_EQ(w.scene.fluid.pbf.iterations, 3);
    EXPECT_FLOAT_EQ(w.scene.fluid.pbf.relaxation, 0.9F) << "what a setting does not name stays as the scene has it";
    // That one misses the frame, and what was picked before has missed already: it says why, once.
    const std::string why = w.second(50, 0.02, &changes);
    EXPECT_EQ(changes, 1);
    EXPECT_NE(why.find("budget.finest"), std::string::npos) << why;
    EXPECT_EQ(w.second(50, 0.02), "");
    EXPECT_NE(w.budget.report().find("not held"), std::string::npos);
}

TEST(Budget, AFrameThatTakesTooLongGetsACheaperSetting) {
    Watched w(120, 0.001F);
    EXPECT_STREQ(w.budget.setting().name, "dfsph");
    // Half of what was planned for the error leaves room for the cheaper one, at twice the error.
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
    EXPECT_NE(said.find("budget of 1e+03 ms and 2 %"), std::string::npos) << said;
    ASSERT_TRUE((*session)->budget());
    const SceneFile& picked = (*session)->scene();
    EXPECT_EQ(picked.fluid.method, (*session)->budget()->setting().method);
    EXPECT_EQ(picked.fluid.method, (*session)->world().params().method);
    EXPECT_FLOAT_EQ(picked.fluid.spacing, 0.015625F) << "a second is enough for the scene's own";
    EXPECT_FLOAT_EQ(picked.budget.finest, 0.015625F);
    for (int k = 0; k < 61; ++k) (*session)->step(1.0 / 60, true);
    EXPECT_NE((*session)->budget()->report().find("measured over 61 frames"), std::string::npos) << (*session)->budget()->report();
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

TEST(Budget, WhatTheSceneRefusesIsRefusedWithIt) {
    const std::vector<CpuKernelRow> rows = cpuKernels();
    auto device = makeCpuDevice(rows);
    for (const char* wrong : {"budget.frameMs=-1", "budget.maxDensityError=0", "budget.frameMs=x", "budget.frame=3"})
        EXPECT_FALSE(loadScene("dam_break", std::vector<std::string>{wrong})) << wrong;
    Result<SceneFile> far = loadScene("dam_break", std::vector<std::string>{"budget.frameMs=5", "fluid.spacing=1e-4"});
    ASSERT_TRUE(far);
    EXPECT_TRUE(Session::create(*far, *device, Log{})) << "too fine for any machine, and the budget picks what this one can";
}

}  // namespace
}  // namespace rivulet
