// Physics cases: their references, scenes and pictures, and the verb that runs them.
#include <gtest/gtest.h>
#include <json/json.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>

#include "engine/core/file.h"
#include "fluid/session/reference_data.h"
#include "fluid/sim/world/cpu_kernels.h"
#include "fluid/validate/clusters.h"
#include "fluid/validate/draught.h"
#include "fluid/validate/known_misses.h"
#include "fluid/validate/orders.h"
#include "fluid/validate/oscillation.h"
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
    const std::vector<glm::dvec2> cavity = referenceCurve("ghia_1982_cavity");
    EXPECT_EQ(cavity.size(), 17U);
    EXPECT_EQ(valueAt(cavity, 0.4531), -0.21090);
    const std::vector<glm::dvec2> faster = referenceCurve("ghia_1982_cavity_400");
    EXPECT_EQ(faster.size(), 17U);
    EXPECT_EQ(valueAt(faster, 0.2813), -0.32726);
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
    p.supportSpacings = 2;
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
        Result<Trial> trial = Trial::open(row.sceneName(), settings);
        ASSERT_TRUE(trial) << trial.error().message;
        EXPECT_EQ(trial->scene().name, row.sceneName());
        const uint32_t particles = trial->world().particles().count;
        EXPECT_GT(particles, 1000U) << row.name;
        EXPECT_LT(particles, 13000U) << row.name;
    }
}

// The keys of a scene that state the experiment: shape, liquid, walls, resolution, probes, and that no air can get into the water
// (negativePressure). All others are numerical parameters, or looks.
const std::regex kExperiment(
    R"(name|doc|duration|fluid\.(method|dfsph\.negativePressure|spacing|liquid|restDensity|viscosity|gravity|forces\.tension|collision\.(walls|friction)|)"
    R"(box\.(min|max|periodic[XYZ])|blocks\.(shape|axis|min|max|velocity|spin|gradient[XYZ]|cut)|probes\.(name|on|index))|)"
    R"(colliders\.(shape|mesh|scale|fitSize|position|rotation|normal|friction|motion\.(shake|shakeFrequency))|)"
    R"(bodies\.(shape|size|radius|density|position|velocity|friction|fixed|sticks))");

void collectKeys(const Json::Value& value, const std::string& path, std::set<std::string>& keys) {
    const bool numbers = value.isArray() && (value.empty() || value[0].isNumeric());
    if (value.isObject())
        for (const std::string& name : value.getMemberNames()) collectKeys(value[name], path.empty() ? name : path + "." + name, keys);
    else if (value.isArray() && !numbers)
        for (const Json::Value& item : value) collectKeys(item, path, keys);
    else
        keys.insert(path);
}

// Cases judge what users get. Numerical parameters belong in PhysicsCase::tuned, in a row that is not judged.
TEST(PhysicsCases, NoJudgedCaseSetsNumericalParameters) {
    std::map<std::string, std::set<std::string>> found;
    for (const fs::directory_entry& entry : fs::directory_iterator(fs::path(RIVULET_SOURCE_DIR) / "assets/cases")) {
        Json::Value scene;
        std::ifstream stream(entry.path());
        ASSERT_TRUE(Json::parseFromStream(Json::CharReaderBuilder(), stream, &scene, nullptr)) << entry.path();
        collectKeys(scene, "", found[entry.path().filename().string()]);
    }
    EXPECT_GE(found.size(), 17U);
    for (const PhysicsCase& row : physicsCases().rows) {
        if (*row.tuned != '\0') {
            for (const std::string& method : methodsOf(row)) EXPECT_FALSE(judges(row, method)) << row.name;
            continue;
        }
        const std::string assignments = std::string(row.quick) + "; " + row.sizes;
        const std::regex key(R"(([A-Za-z][A-Za-z0-9.]*)=)");
        for (std::sregex_iterator at(assignments.begin(), assignments.end(), key), end; at != end; ++at)
            found[row.name].insert(std::regex_replace((*at)[1].str(), std::regex(R"(\.[0-9]+\.)"), "."));
    }
    for (const auto& [name, keys] : found)
        for (const std::string& key : keys)
            EXPECT_TRUE(std::regex_match(key, kExperiment)) << name << " sets " << key << ": a judged case leaves it at its default";
    // Assignments in the functions of the cases.
    const std::regex assignment(R"("((?:fluid|colliders|bodies)\.[A-Za-z0-9.]+)=)");
    for (const fs::directory_entry& entry : fs::directory_iterator(fs::path(RIVULET_SOURCE_DIR) / "fluid/validate")) {
        const std::string text = *readFile(entry.path().string());
        // The table has tuned rows, which are checked above.
        if (text.find("Trial::open(") == std::string::npos || entry.path().filename() == "physics_cases.cpp") continue;
        for (std::sregex_iterator at(text.begin(), text.end(), assignment), end; at != end; ++at) {
            const std::string key = std::regex_replace((*at)[1].str(), std::regex(R"(\.[0-9]+\.)"), ".");
            EXPECT_TRUE(std::regex_match(key, kExperiment)) << entry.path().filename() << " sets " << key;
        }
    }
}

TEST(PhysicsCases, KnownMissesNameJudgedFigures) {
    for (const KnownMiss& k : knownMisses()) {
        const PhysicsCase* row = physicsCases().find(k.name);
        ASSERT_NE(row, nullptr) << k.name;
        EXPECT_TRUE(judges(*row, k.method)) << k.name << ", " << k.method;
        EXPECT_GT(k.cause.size(), 10U) << k.name;
        EXPECT_EQ(knownMiss(k.name, k.method, std::string(k.what) + ", more"), k.cause);
        EXPECT_EQ(knownMiss(k.name, "wcsph_thesis", k.what), "");
    }
    EXPECT_EQ(knownMiss("momentum", "dfsph", "momentum, drift"), "");
    // A known miss is a miss, and does not fail a run.
    const Finding miss{"x", "", 1, 0, 1, 0.1, "the cause"};
    EXPECT_FALSE(miss.pass());
    EXPECT_FALSE(miss.fails());
    EXPECT_TRUE((Finding{"x", "", 1, 0, 1, 0.1, {}}).fails());
}

TEST(Oscillation, IsRecoveredFromItsCurve) {
    for (const double decay : {0.0, 0.4, 2.0}) {
        std::vector<glm::dvec2> curve;
        for (int i = 0; i < 300; ++i) {
            const double t = 0.3 + i / 60.0;
            curve.emplace_back(t, 0.02 + 0.5 * std::exp(-decay * t) * std::cos(4.2 * t + 1.1));
        }
        const Oscillation o = fitOscillation(curve, 5.3);
        EXPECT_NEAR(o.frequency, 4.2, 1e-5);
        EXPECT_NEAR(o.decay, decay, 1e-5);
        EXPECT_NEAR(o.amplitude, 0.5, 1e-5);
        EXPECT_NEAR(o.offset, 0.02, 1e-6);
        EXPECT_LT(o.misfit, 1e-5);
    }
}

TEST(Clusters, AreConnectedByDistanceAlsoAcrossThePeriod) {
    std::vector<vec4> positions;
    for (int k = 0; k < 30; ++k) positions.emplace_back(0.1F * static_cast<float>(k), 0, 0.05F, 1);
    EXPECT_EQ(largestCluster(positions, 0.15, 1), 1);
    positions[10].w = -1;  // a free slot parts them
    EXPECT_NEAR(largestCluster(positions, 0.15, 1), 19.0 / 29, 1e-12);
    EXPECT_NEAR(largestCluster(positions, 0.05, 1), 1.0 / 29, 1e-12);
    EXPECT_EQ(largestCluster(positions, 0.25, 1), 1);
    const vec4 across[] = {{0, 0, 0.03F, 1}, {0, 0, 0.97F, 1}};
    EXPECT_EQ(largestCluster(across, 0.1, 1), 1);
    EXPECT_EQ(largestCluster(across, 0.1, 2), 0.5);
}

TEST(Clusters, TheCoveredVolumeIsThatOfTheUnion) {
    const double ball = 4.0 / 3 * M_PI * 0.027;
    const vec4 one[] = {{0.21F, -0.3F, 0.5F, 1}, {0.21F, -0.3F, 0.5F, 1}, {5, 5, 5, -1}};
    EXPECT_NEAR(coveredVolume(one, 0.3, 0.02, 2), ball, 0.01 * ball);
    const vec4 apart[] = {{0, 0, 0.05F, 1}, {0.9F, 0, 1.95F, 1}};
    EXPECT_NEAR(coveredVolume(apart, 0.3, 0.02, 2), 2 * ball, 0.02 * ball) << "cut by the border of the period, and whole";
    // A slab of a lattice, covered without gaps: its volume, and no more than a radius beyond its faces.
    std::vector<vec4> slab;
    for (int k = 0; k < 20 * 20 * 4; ++k)
        slab.emplace_back(0.1F * static_cast<float>(k % 20), 0.1F * static_cast<float>(k / 20 % 20),
                          0.05F + 0.1F * static_cast<float>(k / 400), 1);
    const double volume = coveredVolume(slab, 0.09, 0.025, 0.4);
    EXPECT_GT(volume, 1.9 * 1.9 * 0.4);
    EXPECT_LT(volume, 2.08 * 2.08 * 0.4);
}

TEST(Orders, AreTheSlopeOfTheLogarithms) {
    const std::vector<double> spacings = {0.04, 0.03, 0.02, 0.01};
    std::vector<double> errors;
    for (const double d : spacings) errors.push_back(3 * std::pow(d, 1.7));
    EXPECT_NEAR(orderOf(spacings, errors), 1.7, 1e-12);
    errors[2] = 0;
    EXPECT_TRUE(std::isnan(orderOf(spacings, errors)));
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
    const double steps = trial->outcome({}, {})->sweepsPerSecond * trial->time() / 2;
    EXPECT_NEAR(steps, std::round(steps), 1e-9);
    EXPECT_GE(steps, 2);
    EXPECT_GT(trial->outcome({}, {})->wallPerSecond, 0);
}

// Sweeps are those of the particles that are awake: a pool that sleeps for half of the time has fewer than two a step.
TEST(PhysicsCases, ATrialCountsNoSweepsOfSleepingWater) {
    auto device = cpu();
    CaseSettings settings;
    settings.device = device.get();
    settings.method = "wcsph";
    settings.assignments = {"fluid.spacing=0.1", "fluid.sleep.on=true", "duration=6"};
    Result<Trial> trial = Trial::open("hydrostatic", settings);
    ASSERT_TRUE(trial) << trial.error().message;
    double share = 0;  // of the time, without the particles that still were awake
    EXPECT_TRUE(trial->run(1.0 / 60, [&] { share += trial->world().stats().asleep == trial->world().stats().particles ? 1.0 / 60 : 0; }));
    share /= trial->time();
    const Result<Outcome> made = trial->outcome({}, {});
    ASSERT_TRUE(made) << made.error().message;
    const Outcome& o = *made;
    EXPECT_GT(share, 0.2);
    EXPECT_LT(o.sweepsPerSecond, 2 * (1.02 - share) * o.stepsPerSecond);
    EXPECT_GT(o.sweepsPerSecond, 0.2 * o.stepsPerSecond);
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
