// Physics cases: their references, scenes and pictures, and the verb that runs them.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "engine/core/file.h"
#include "fluid/session/reference_data.h"
#include "fluid/sim/world/cpu_kernels.h"
#include "fluid/validate/draught.h"
#include "fluid/validate/trial.h"
#include "fluid/validate/virial.h"

namespace rivulet::validate_test {
namespace {

namespace fs = std::filesystem;

std::unique_ptr<CpuDevice> cpu() {
    const std::vector<CpuKernelRow> rows = cpuKernels();
    return makeCpuDevice(rows);
}

TEST(ReferenceData, EqualsThePapers) {
    const std::vector<glm::dvec2> front = referenceCurve("martin_moyce_1952_front");
    ASSERT_EQ(front.size(), 15U);
    EXPECT_EQ(front.front(), glm::dvec2(0.41, 1.11));
    EXPECT_EQ(front.back(), glm::dvec2(3.33, 4.11));
    // Between T = 1.43 and 3.33 the front goes 2.44 a.
    EXPECT_NEAR((front.back().y - valueAt(front, 1.43)) / (3.33 - 1.43), 1.284, 1e-3);
    EXPECT_EQ(referenceCurve("martin_moyce_1952_height").size(), 17U);
    EXPECT_EQ(referenceCurve("koshizuka_oka_1996_front").back(), glm::dvec2(3.096, 3.624));
    // A quarter of the peak of 11.2 kPa at 0.395 s; gauge 4 stands in the reservoir.
    const std::vector<glm::dvec2> p1 = referenceCurve("kleefsman_2005", 0, 1), h4 = referenceCurve("kleefsman_2005", 0, 12);
    EXPECT_LT(valueAt(p1, 0.39), 100);
    EXPECT_NEAR(valueAt(p1, 0.395), 2800, 100);
    EXPECT_NEAR(h4.front().y, 0.55, 0.005);
    EXPECT_NEAR(h4.back().x, 6, 0.011);
    for (const ReferenceTable& table : referenceTables()) EXPECT_NE(table.text.find("doi:"), std::string_view::npos) << table.name;
}

TEST(ReferenceData, IsInterpolatedLinearly) {
    const std::vector<glm::dvec2> curve = {{0, 1}, {2, 5}, {3, 4}};
    EXPECT_EQ(valueAt(curve, -1), 1);
    EXPECT_EQ(valueAt(curve, 0.5), 2);
    EXPECT_EQ(valueAt(curve, 2), 5);
    EXPECT_EQ(valueAt(curve, 2.25), 4.75);
    EXPECT_EQ(valueAt(curve, 9), 4);
}

// A lattice under one pressure passes on a third of the sum of V r |W'|, here by counting; off a lattice, as much on average.
TEST(VirialPressure, OfALatticeIsThePressureOfItsPairs) {
    FluidParams p;
    p.spacing = 0.1F;
    const double support = double{p.supportSpacings};
    double shape = 0, passed = 0;
    for (int z = -3; z <= 3; ++z)
        for (int y = -3; y <= 3; ++y)
            for (int x = -3; x <= 3; ++x) {
                const double q = std::sqrt(x * x + y * y + z * z) / support;
                if (q >= 1) continue;
                shape += std::pow(1 - q, 4) * (1 + 4 * q);
                passed += 20 * q * q * std::pow(1 - q, 3) / 3;
            }
    EXPECT_NEAR(passed / shape, 0.95, 0.001);
    std::vector<vec4> positions;
    positions.reserve(9 * 9 * 9);
    for (int k = 0; k < 9 * 9 * 9; ++k) {
        const ivec3 place(k % 9, k / 9 % 9, k / 81);
        positions.emplace_back(0.1F * vec3(place) - vec3(0, 0, 5), 1.0F);
    }
    const size_t middle = 4 + 9 * 4 + 81 * 4;
    std::vector<float> pressures(positions.size(), 700.0F);
    EXPECT_NEAR(virialPressures(positions, pressures, p)[middle], 700 * passed / shape, 0.01);
    // Of its own pressure it passes on half, of its neighbours' half.
    pressures[middle] = 0;
    EXPECT_NEAR(virialPressures(positions, pressures, p)[middle], 350 * passed / shape, 0.01);
    // A free slot does not count.
    positions[middle].w = -1;
    EXPECT_EQ(virialPressures(positions, pressures, p)[middle], 0);
}

TEST(PhysicsCases, EachHasItsSceneAndAQuickSize) {
    auto device = cpu();
    for (const PhysicsCase& row : physicsCases().rows) {
        if (methodsOf(row).front() != "dfsph") continue;  // no scene of particles
        CaseSettings settings;
        settings.device = device.get();
        settings.quick = true;
        Result<Trial> trial = Trial::open(row.name, settings);
        ASSERT_TRUE(trial) << trial.error().message;
        EXPECT_EQ(trial->scene().name, row.name);
        const uint32_t particles = trial->world().particles().count;
        EXPECT_GT(particles, 1000U) << row.name;
        EXPECT_LT(particles, 13000U) << row.name;
    }
}

TEST(PhysicsCases, ATrialGivesVelocitiesByPlaceAndCountsItsSweeps) {
    auto device = cpu();
    CaseSettings settings;
    settings.device = device.get();
    settings.method = "wcsph";
    settings.assignments = {"fluid.spacing=0.1", "duration=0.01"};
    Result<Trial> trial = Trial::open("momentum", settings);
    ASSERT_TRUE(trial) << trial.error().message;
    ASSERT_TRUE(trial->setVelocities([](const glm::dvec3& x) { return glm::dvec3(-x.y, x.x, 0.0); }));
    const HostParticles before = trial->particles();
    ASSERT_GT(before.position.size(), 100U);
    for (size_t i = 0; i < before.position.size(); ++i) {
        EXPECT_EQ(before.velocity[i].x, -before.position[i].y);
        EXPECT_EQ(before.velocity[i].y, before.position[i].x);
    }
    int frames = 0;
    EXPECT_TRUE(trial->run(0.005, [&] { ++frames; }));
    EXPECT_EQ(frames, 2);
    // Density and forces, a step each.
    const double steps = trial->outcome({}, {}).sweepsPerSecond * trial->time() / 2;
    EXPECT_NEAR(steps, std::round(steps), 1e-9);
    EXPECT_GE(steps, 2);
    EXPECT_GT(trial->outcome({}, {}).wallPerSecond, 0);
}

TEST(PhysicsCases, AStoppedTrialStops) {
    auto device = cpu();
    CaseSettings settings;
    settings.device = device.get();
    settings.assignments = {"fluid.spacing=0.1"};
    int asked = 0;
    settings.goOn = [&](double share) {
        EXPECT_LT(share, 0.1);
        return ++asked < 3;
    };
    Result<Outcome> outcome = runMomentum(settings);
    ASSERT_TRUE(outcome);
    EXPECT_EQ(asked, 3);
    EXPECT_TRUE(outcome->findings.empty());
}

TEST(PhysicsCases, UnsupportedFeaturesAreReportedAndInvalidRequestsAreErrors) {
    auto device = cpu();
    CaseSettings settings;
    settings.device = device.get();
    settings.quick = true;
    settings.method = "wcsph_thesis";
    const PhysicsCase& row = *physicsCases().find("couette");
    const Result<Outcome> refused = runCase(row, settings);
    ASSERT_TRUE(refused);
    EXPECT_EQ(refused->method, "wcsph_thesis");
    ASSERT_EQ(refused->findings.size(), 1U);
    EXPECT_NE(refused->findings[0].what.find("periodic"), std::string::npos) << refused->findings[0].what;
    EXPECT_FALSE(refused->findings[0].tolerance);
    EXPECT_TRUE(refused->findings[0].pass());
    settings.assignments = {"fluid.spacing=-1"};
    EXPECT_FALSE(runCase(row, settings));
    settings.assignments = {"colliders.0.mesh=meshes/none.obj"};
    EXPECT_FALSE(runCase(row, settings)) << "nobody can do it";
    settings.assignments = {"fluid.kernel=cubic_spline"};
    settings.method = "dfsph";
    EXPECT_FALSE(runCase(row, settings)) << "the judged method has to do it";
}

TEST(Draught, TheLevelIncludesWaterAndTheSubmergedVolume) {
    // Half a cubic metre of water on a square metre, a box of 0.5 x 0.4 x 0.5 m with its keel at 0.3 m: the level is y where
    // 0.5 + 0.25 (y - 0.3) = y.
    const Floater box{0.4, 0.1, 0.3};
    const double level = (0.5 - 0.25 * 0.3) / 0.75;
    EXPECT_NEAR(waterLevel(0.5, 1, std::span(&box, 1)), level, 1e-12);
    EXPECT_NEAR(box.shareUnder(level - box.keel), (level - 0.3) / 0.4, 1e-12);
    const Floater both[] = {{0.4, 0.1, 0.9}, {0.1, 0.01, 0.0}};
    EXPECT_NEAR(waterLevel(0.5, 1, both), 0.51, 1e-12) << "one is out of it, one is under";
    // A ball: the cap's volume is pi d^2 (3 r - d) / 3.
    const Floater ball{2, 4.0 / 3 * M_PI, 0, true};
    EXPECT_NEAR(ball.shareUnder(0.5), M_PI * 0.25 * 2.5 / 3 / ball.volume, 1e-12);
    // Particles that are pressed together take less room; a free slot takes none.
    const vec4 particles[] = {{0, 0, 0, 1}, {0, 0, 0, 1.25}, {0, 0, 0, 0.5}, {0, 0, 0, -1}};
    EXPECT_NEAR(waterVolume(particles, 0.5), 0.125 * 2.8, 1e-7);
}

TEST(PhysicsCases, AFindingWithoutToleranceIsOnlyReported) {
    EXPECT_TRUE((Finding{"x", "", 1, 0, 1, {}}).pass());
    EXPECT_TRUE((Finding{"x", "", 1, 0, 0.01, 0.01}).pass());
    EXPECT_FALSE((Finding{"x", "", 1, 0, 0.011, 0.01}).pass());
    EXPECT_FALSE((Finding{"x", "", 1, 0, std::nan(""), 0.01}).pass());
}

TEST(PhysicsCases, APlotWithAnyTextIsAValidSvg) {
    const std::string path = (fs::temp_directory_path() / "rivulet_plot_test.svg").string();
    fs::remove(path);
    const Plot plot{
        "a \"title\" \\ with % and _", "x", "y", {{"line", true, {{0, 0}, {1, 2}}}, {"none", true, {}}, {"dots", false, {{0.5, 1}}}}};
    const Status drawn = drawPlot(plot, path);
    ASSERT_TRUE(drawn) << drawn.error().message;
    const std::string svg = *readFile(path);
    EXPECT_NE(svg.find("<svg"), std::string::npos);
    EXPECT_NE(svg.find("title"), std::string::npos);
    EXPECT_NE(svg.find("dots"), std::string::npos);
    EXPECT_EQ(svg.find(">none<"), std::string::npos);
    EXPECT_FALSE(drawPlot(plot, "/nowhere/x.svg"));
    const std::string old = std::getenv("PATH");
    ::setenv("PATH", "/nowhere", 1);
    const Status absent = drawPlot(plot, path);
    ::setenv("PATH", old.c_str(), 1);
    ASSERT_FALSE(absent);
    EXPECT_NE(absent.error().message.find("gnuplot is not installed"), std::string::npos) << absent.error().message;
    fs::remove(path);
}

}  // namespace
}  // namespace rivulet::validate_test
