// Skins in scenes: valid and refused files, and conservation of volume from an eye to the ground.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>

#include "engine/compute/device_cpu.h"
#include "engine/core/json.h"
#include "fluid/session/run_stats.h"
#include "fluid/session/session.h"
#include "fluid/sim/world/cpu_kernels.h"

namespace rivulet::scene_flow_test {
namespace {

std::unique_ptr<CpuDevice> cpu() {
    const std::vector<CpuKernelRow> rows = cpuKernels();
    return makeCpuDevice(rows);
}

SceneFile crying(std::vector<std::string> assignments = {}, const std::string& preset = "") {
    assignments.insert(assignments.begin(), "flow.0.mesh=meshes/head/head.glb");  // wherever an ICT head may be
    Result<SceneFile> scene = loadScene("crying", assignments, preset);
    EXPECT_TRUE(scene) << (scene ? "" : scene.error().message);
    return scene ? *scene : SceneFile{};
}

TEST(SceneFlow, NothingIsLostBetweenEyesAirAndGround) {
    auto device = cpu();
    // Rain, sobs and sweat at once, gusts, a face that moves.
    Result<std::unique_ptr<Session>> session =
        Session::create(crying({"flow.0.sources.0.rate=400", "flow.0.sources.2.rate=2000", "flow.0.sources.3.rate=40000",
                                "flow.0.wind=3,0,1", "flow.0.motion.swing=8,5,3", "flow.0.motion.period=0.7", "flow.0.mapSize=64"}),
                        *device, {});
    ASSERT_TRUE(session) << session.error().message;
    RunRecorder recorder((*session)->world(), (*session)->fields(), true, &(*session)->flows());
    for (int k = 0; k < 180; ++k) {
        const double ms = (*session)->step(1.0 / 60, true);
        recorder.stepped(ms, {});
        for (const SkinDrop& d : (*session)->flows().skins()[0]->flow().drops()) EXPECT_TRUE(isFinite(d.position) && isFinite(d.velocity));
    }
    const RunStats stats = recorder.finish("crying");
    EXPECT_EQ(stats.ledger.error, 0.0);
    const double lids = 2.0e-9 * static_cast<double>(crying().flow[0].liquid.brimStarts);  // m^3
    EXPECT_NEAR(stats.ledger.emitted, (lids + 3.0 / 60 * (400 + 2000 + 40000) * 1e-9), 0.3e-9 + 0.02 * stats.ledger.emitted);
    EXPECT_GT(stats.ledger.onSurface, 0.0);
    EXPECT_GT(stats.ledger.drained, 0.0);
    EXPECT_NEAR(stats.ledger.onSurface + stats.ledger.inAir + stats.ledger.evaporated + stats.ledger.drained, stats.ledger.emitted, 1e-15);
    // From the start again.
    (*session)->reset();
    EXPECT_NEAR((*session)->flows().ledger().emitted, lids, 1e-12);
}

TEST(SceneFlow, AClickPutsADropOnTheSkin) {
    auto device = cpu();
    Result<std::unique_ptr<Session>> session = Session::create(crying({"flow.0.sources.0.rate=0", "flow.0.mapSize=64"}), *device, {});
    ASSERT_TRUE(session);
    SkinFlows& flows = (*session)->flows();
    EXPECT_FALSE(flows.drip(dvec3(0, 1, 1), dvec3(0, 0, -2), 8000000));  // over the head
    EXPECT_TRUE(flows.drip(dvec3(0.03, -0.02, 1), dvec3(0, 0, -2), 8000000));
    (*session)->step(1.0 / 60, true);
    size_t there = 0;
    for (const SkinDrop& d : flows.skins()[0]->flow().drops())
        if (d.volume > 6e-9) {
            ++there;
            EXPECT_LT(glm::distance(d.position, vec3(0.03F, -0.021F, d.position.z)), 0.004F);
            EXPECT_GT(d.position.z, 0.02F);
        }
    EXPECT_EQ(there, 1U);
}

TEST(SceneFlow, PresetsSetTheirValues) {
    const SceneFile sob = crying({}, "sob"), rain = crying({"flow.0.sources.3.drop=2"}, "rain on a statue");
    EXPECT_GT(sob.flow[0].sources[0].rate, 100);
    EXPECT_EQ(rain.flow[0].sources[0].rate, 0);
    EXPECT_GT(rain.flow[0].sources[3].rate, 0);
    EXPECT_EQ(rain.flow[0].sources[3].drop, 2);
    for (const PresetParams& preset : sob.presets) {
        SceneFile any = sob;
        EXPECT_TRUE(applyPreset(any, preset.name)) << preset.name;
    }
    const Result<SceneFile> none = loadScene("crying", {}, "laugh");
    ASSERT_FALSE(none);
    EXPECT_NE(none.error().message.find("quiet cry"), std::string::npos) << none.error().message;
}

TEST(SceneFlow, InvalidValuesAreRefusedByName) {
    struct Row {
        const char *set, *says;
    };
    auto device = cpu();
    for (const Row& row :
         {Row{"flow.0.mesh=meshes/none.glb", "meshes/none.glb"}, Row{"flow.0.part=skinn", "there are skin"},
          Row{"flow.0.expression.0.morph=frwn", "did you mean frown?"}, Row{"flow.0.regions.mask=meshes/none.png", "none.png"},
          Row{"flow.0.mapSize=1000", "power of two"}, Row{"flow.0.marks=meshes/spot.obj", "spot.obj"}}) {
        Result<SceneFile> scene = loadScene("crying", std::vector<std::string>{"flow.0.mesh=meshes/head/head.glb", row.set});
        ASSERT_TRUE(scene) << row.set << ": " << scene.error().message;
        const auto session = Session::create(*scene, *device, {});
        ASSERT_FALSE(session) << row.set;
        EXPECT_NE(session.error().message.find(row.says), std::string::npos) << session.error().message;
        EXPECT_NE(session.error().message.find("flow[0]"), std::string::npos) << session.error().message;
    }
    for (const char* set : {"flow.0.mapSize=0", "flow.0.mapSize=65536", "flow.0.sources.0.drop=0", "flow.0.wind=1e7,0,0"})
        EXPECT_FALSE(loadScene("crying", std::vector<std::string>{set})) << set;
    // A mesh without eyes has no lids to fill.
    Result<SceneFile> cow = loadScene("rain_on_spot", std::vector<std::string>{"flow.0.sources.0.kind=brim"});
    ASSERT_TRUE(cow);
    const auto session = Session::create(*cow, *device, {});
    ASSERT_FALSE(session);
    EXPECT_NE(session.error().message.find("no marks of eyes"), std::string::npos) << session.error().message;
}

// A storm blows all there is off, and nothing becomes Inf.
TEST(SceneFlow, AStormIsNoEnd) {
    auto device = cpu();
    Result<std::unique_ptr<Session>> session =
        Session::create(crying({"flow.0.sources.2.rate=60000", "flow.0.wind=1e6,0,0", "flow.0.mapSize=64"}), *device, {});
    ASSERT_TRUE(session);
    for (int k = 0; k < 30; ++k) {
        (*session)->step(1.0 / 60, true);
        for (const SkinDrop& d : (*session)->flows().skins()[0]->flow().drops()) EXPECT_TRUE(isFinite(d.position) && isFinite(d.velocity));
    }
    EXPECT_EQ((*session)->flows().ledger().error, 0.0);
}

// Without UVs a skin gets its own: the sheet that they are drawn from is split, and drops go where they went.
TEST(SceneFlow, ASkinWithoutUvsIsLaidOut) {
    auto device = cpu();
    std::string said;
    Log log;
    log.sink = [&](LogLevel, std::string_view text) { said += text; };
    Result<SceneFile> scene = loadScene("rain_on_spot", std::vector<std::string>{"flow.0.mesh=meshes/sphere.obj", "flow.0.mapSize=256"});
    ASSERT_TRUE(scene);
    Result<std::unique_ptr<Session>> session = Session::create(*scene, *device, log);
    ASSERT_TRUE(session) << session.error().message;
    EXPECT_NE(said.find("UV"), std::string::npos) << said;
    for (int k = 0; k < 60; ++k) (*session)->step(1.0 / 60, true);
    EXPECT_GT((*session)->flows().skins()[0]->maps().tiles(), 100U);
    EXPECT_GT((*session)->flows().ledger().onSurface, 0.0);
}

// A jet over a basin: its particles become drops on the cow, drops that drip from it are deposited in the basin and become particles there.
TEST(SceneFlow, TheSameWaterIsInBothWorlds) {
    auto device = cpu();
    Result<SceneFile> scene = loadScene("shower", std::vector<std::string>{"flow.0.mapSize=64", "fluid.spacing=0.008",
                                                                           "emitters.0.litresPerSecond=0.06", "emitters.0.stop=0.8"});
    ASSERT_TRUE(scene) << scene.error().message;
    Result<std::unique_ptr<Session>> session = Session::create(*scene, *device, {});
    ASSERT_TRUE(session) << session.error().message;
    FluidWorld& world = (*session)->world();
    RunRecorder recorder(world, (*session)->fields(), true, &(*session)->flows());
    double most = 0;
    for (int k = 0; k < 90; ++k) {
        const double ms = (*session)->step(1.0 / 60, true);
        recorder.stepped(ms, {});
        most = std::max(most, (*session)->flows().ledger().onSurface);
    }
    const RunStats stats = recorder.finish("shower");
    EXPECT_EQ(stats.ledger.error, 0.0);
    const RunStats::Ledger& l = stats.ledger;
    EXPECT_NEAR(l.onSurface + l.inAir + l.inWorld + l.evaporated + l.drained, l.emitted, 1e-14);
    EXPECT_GT(most, 5e-6);
    const double jet = 0.5 * 0.06e-3;  // m^3: a nozzle lets whole layers out
    // Particles spawned above the water beside the cow may land on it again.
    EXPECT_GT(world.stats().withdrawn, 0.75 * jet);
    EXPECT_LT(world.stats().withdrawn, 1.25 * jet + world.stats().deposited);
    EXPECT_GT(world.stats().deposited, 0.2 * jet);
    EXPECT_LT(l.pending, 8 * std::pow(0.008, 3));
    EXPECT_EQ(stats.lost, 0U);
    for (const SkinDrop& d : (*session)->flows().skins()[0]->flow().drops()) EXPECT_TRUE(isFinite(d.position));
    (*session)->reset();
    EXPECT_EQ((*session)->flows().ledger().taken, 0.0);
    EXPECT_EQ(world.stats().withdrawn, 0.0);
}

// A drop that hangs in the air is met by a skin that comes to it: faster than the drop is wide in a frame.
TEST(SceneFlow, AMovingSkinCollectsDropsInItsPath) {
    auto device = cpu();
    Result<SceneFile> scene = loadScene(
        "rain_on_spot",
        std::vector<std::string>{"flow.0.mesh=meshes/sphere.obj", "flow.0.fitSize=0.1", "flow.0.mapSize=64", "fluid.gravity=0,0,0",
                                 "flow.0.position=0,0,0", "flow.0.motion.pivot=0,0,-0.5", "flow.0.motion.swing=40,0,0",
                                 "flow.0.motion.period=1", "flow.0.sources.0.rate=100000", "flow.0.sources.0.drop=4",
                                 "flow.0.sources.0.speed=0", "flow.0.sources.0.along=0,-1,0", "flow.0.sources.0.stop=0.02"});
    ASSERT_TRUE(scene) << scene.error().message;
    Result<std::unique_ptr<Session>> session = Session::create(*scene, *device, {});
    ASSERT_TRUE(session) << session.error().message;
    for (int k = 0; k < 3; ++k) (*session)->step(1.0 / 60, true);
    const size_t hang = (*session)->flows().inAir();
    ASSERT_GT(hang, 5U);
    for (int k = 0; k < 60; ++k) (*session)->step(1.0 / 60, true);
    EXPECT_LT((*session)->flows().inAir(), hang);
    EXPECT_GT((*session)->flows().ledger().onSurface, 0.0);
    EXPECT_EQ((*session)->flows().ledger().error, 0.0);
}

// Drops that rain on two skins, 2 m apart: each has the wind of its own skin, and a liquid half as dense is blown twice as fast.
TEST(SceneFlow, DropsInTheAirHaveTheWindAndTheDensityOfTheirOwnSkin) {
    auto device = cpu();
    Result<SceneFile> scene =
        loadScene("rain_on_spot",
                  std::vector<std::string>{"flow.0.mesh=meshes/sphere.obj", "flow.0.fitSize=0.1", "flow.0.mapSize=256",
                                           "fluid.gravity=0,0,0", "flow.0.position=0,0,0", "flow.0.wind=5,0,0",
                                           "flow.0.liquid.density=1000", "flow.0.sources.0.rate=20000", "flow.0.sources.0.drop=4",
                                           "flow.0.sources.0.speed=0", "flow.0.sources.0.along=0,-1,0", "flow.0.sources.0.stop=0.02"});
    ASSERT_TRUE(scene) << scene.error().message;
    scene->flow.push_back(scene->flow[0]);
    scene->flow[1].position.x = 2;
    scene->flow[1].wind.x = -5;
    scene->flow[1].liquid.density = 500;
    Result<std::unique_ptr<Session>> session = Session::create(*scene, *device, {});
    ASSERT_TRUE(session) << session.error().message;
    for (int k = 0; k < 3; ++k) (*session)->step(1.0 / 60, true);
    std::array<double, 2> speed{}, count{};
    const std::vector<vec4> drops = (*session)->flows().airDrops();
    for (size_t k = 0; k + 1 < drops.size(); k += 2) {
        const size_t skin = drops[k].x > 1 ? 1 : 0;
        speed[skin] += double{drops[k + 1].x};
        ++count[skin];
    }
    ASSERT_GT(std::min(count[0], count[1]), 1);
    speed[0] /= count[0];
    speed[1] /= count[1];
    EXPECT_GT(speed[0], 0.05);
    EXPECT_LT(speed[1], 0);
    EXPECT_NEAR(-speed[1] / speed[0], 2, 0.2);
}

// One pulse in each period, of the given height and width. It starts at another time in each period, and at the same time for both eyes.
TEST(SceneFlow, ABlinkIsAPulseInEachPeriod) {
    ExpressionParams left;
    left.swing = 1;
    left.period = 4;
    left.pulse = 0.3F;
    ExpressionParams right = left;
    right.weight = 0.25F;
    std::vector<double> starts;
    for (int n = 0; n < 12; ++n) {
        double start = -1, most = 0, width = 0;
        for (int k = 0; k < 4000; ++k) {
            const double time = 4 * n + k / 1000.0, w = left.at(time);
            if (w > 0 && start < 0) start = time - 4 * n;
            most = std::max(most, w);
            width += w > 0 ? 0.001 : 0;
            EXPECT_NEAR(right.at(time), std::min(w + 0.25, 1.0), 1e-12);
        }
        EXPECT_NEAR(most, 1, 1e-4);
        EXPECT_NEAR(width, 0.3, 0.004);
        starts.push_back(start);
    }
    EXPECT_GT(*std::max_element(starts.begin(), starts.end()) - *std::min_element(starts.begin(), starts.end()), 0.4);
    left.pulse = 0;
    EXPECT_NEAR(left.at(1), 1, 1e-12) << "a sine wave";
    EXPECT_EQ(left.at(3), 0);
}

// Within three seconds of the start, each eye has spilled a tear.
TEST(SceneFlow, TheFirstTearsSpillAtOnce) {
    auto device = cpu();
    Result<std::unique_ptr<Session>> session = Session::create(crying({"flow.0.mapSize=64"}), *device, {});
    ASSERT_TRUE(session) << session.error().message;
    for (int k = 0; k < 180; ++k) (*session)->step(1.0 / 60, true);
    std::array<int, 2> spilled{};
    for (const SkinDrop& d : (*session)->flows().skins()[0]->flow().drops())
        if (d.volume > 1.0e-9 && d.way > 0.002) ++spilled[d.position.x > 0 ? 1 : 0];
    EXPECT_GE(spilled[0], 1);
    EXPECT_GE(spilled[1], 1);
}

// A brim whose position a person has set: the tears of the nearer eye start there, the other's at its lid, and none is lost.
TEST(SceneFlow, AMovedTearPointIsWhereTearsStart) {
    auto device = cpu();
    const vec3 cheek(0.040F, 0.0F, 0.045F);
    Result<std::unique_ptr<Session>> session =
        Session::create(crying({"flow.0.mapSize=64", "flow.0.sources.0.position=0.040,0,0.045", "flow.0.liquid.brimStarts=1.2",
                                "flow.0.sources.0.rate=600", "flow.0.expressive=0"}),
                        *device, {});
    ASSERT_TRUE(session) << session.error().message;
    const FlowComponent& skin = *(*session)->flows().skins()[0];
    const SkinPoint start = nearestPoint(skin.flow().mesh(), cheek);
    const vec3 at = positionOf(skin.flow().mesh(), start);
    int there = 0, elsewhere = 0, right = 0;
    for (int k = 0; k < 300; ++k) {
        (*session)->step(1.0 / 60, true);
        for (const SkinDrop& d : skin.flow().drops()) {
            if (d.volume < 3.0e-9 || d.way > 0.004) continue;
            if (d.position.x < 0)
                ++right;
            else
                ++(glm::distance(d.position, at) < 0.006F ? there : elsewhere);
        }
    }
    EXPECT_GT(there, 0);
    EXPECT_EQ(elsewhere, 0) << "the left lid does not fill";
    EXPECT_GT(right, 0);
    EXPECT_EQ((*session)->flows().ledger().error, 0.0);
    const std::vector<FlowComponent::TearPoint> points = skin.tearPoints();
    ASSERT_EQ(points.size(), 2U);
    EXPECT_LT(
        glm::distance(vec3(glm::inverse((*session)->flows().skins()[0]->placed().toWorld()) * glm::dvec4(dvec3(points[0].world), 1)), at),
        2e-3F);
}

TEST(SceneFlow, AmountScalesAllSources) {
    auto device = cpu();
    double emitted[2];
    for (const int twice : {0, 1}) {
        Result<std::unique_ptr<Session>> session = Session::create(
            crying({"flow.0.mapSize=64", "flow.0.sources.0.swell=0", twice != 0 ? "flow.0.amount=2" : "flow.0.amount=1"}), *device, {});
        ASSERT_TRUE(session) << session.error().message;
        for (int k = 0; k < 120; ++k) (*session)->step(1.0 / 60, true);
        emitted[twice] = (*session)->flows().ledger().emitted - 2.0e-9 * double{(*session)->scene().flow[0].liquid.brimStarts};
    }
    EXPECT_NEAR(emitted[1], 2 * emitted[0], 0.02 * emitted[1]);
}

// What is drawn of a lid, its lashes and its film, follows what is in it; a device reports that without a wait.
TEST(SceneFlow, TheContentOfLidsIsReported) {
    auto device = cpu();
    Result<std::unique_ptr<Session>> session = Session::create(crying({"flow.0.mapSize=64", "flow.0.sources.0.rate=0"}), *device, {});
    ASSERT_TRUE(session) << session.error().message;
    std::vector<uint64_t> content;
    (*session)->flows().skins()[0]->flow().brimsLater([&](std::span<const uint64_t> now) { content.assign(now.begin(), now.end()); });
    ASSERT_EQ(content.size(), 2U);
    const double starts = 1.0e6 * double{(*session)->scene().flow[0].liquid.brimStarts};
    for (const uint64_t one : content) EXPECT_NEAR(static_cast<double>(one), starts, 1e-4 * starts);
}

// Marks on a ball whose file has +z up, set upright by the scene's rotation: without `up` in the file, liquid spills below the lids in the
// scene, before the face; with the file's `up` and `forward` at the same places.
TEST(SceneFlow, WithoutUpLidsSpillDownwardsInTheScene) {
    const std::string folder = ::testing::TempDir();
    const auto write = [&](const std::string& name, const std::string& axes) {
        std::string text = "{" + axes + "\"eyes\": {";
        for (const float side : {0.03F, -0.03F}) {  // the face looks along the file's -y
            text += fmt::format("{}\"{}\": {{\"lower_lid_margin\": [", side < 0 ? ", " : "", side > 0 ? "left" : "right");
            for (const float x : {-0.01F, 0.0F, 0.01F}) {
                const vec3 p = glm::normalize(vec3(side + x, -0.09F, 0.03F));
                text += fmt::format("{}[{}, {}, {}]", x > -0.01F ? ", " : "", p.x, p.y, p.z);
            }
            text += "]}";
        }
        std::ofstream(folder + name) << text << "}}";
        return folder + name;
    };
    for (const std::string& marks : {write("bare_marks.json", ""), write("upright_marks.json", "\"up\": [0, 0, 1], "),
                                     write("full_marks.json", "\"up\": [0, 0, 1], \"forward\": [0, -1, 0], ")}) {
        SceneFile scene = crying();
        FlowParams& flow = scene.flow[0];
        flow = FlowParams();
        flow.mesh = "meshes/sphere.obj";
        flow.marks = marks;
        flow.scale = 0.1F;
        flow.rotation = vec3(-90, 0, 0);
        flow.mapSize = 64;
        flow.liquid.brimStarts = 7.9F;
        flow.sources.assign(1, FlowSourceParams());
        flow.sources[0].kind = "brim";
        flow.sources[0].rate = 600;
        auto device = cpu();
        Result<std::unique_ptr<Session>> session = Session::create(scene, *device, {});
        ASSERT_TRUE(session) << session.error().message;
        size_t spilled = 0;
        for (int k = 0; k < 60; ++k) {
            (*session)->step(1.0 / 60, true);
            for (const SkinDrop& d : (*session)->flows().skins()[0]->flow().drops()) {
                if (d.volume < 2e-9 || d.way > 0.002) continue;  // tears that have just spilled
                ++spilled;
                EXPECT_LT(d.position.y, 0.0292F) << marks;
                EXPECT_GT(d.position.y, 0.02F) << marks;
                EXPECT_GT(d.position.z, 0.08F) << marks;
            }
        }
        EXPECT_GT(spilled, 0U) << marks;
    }
}

TEST(SceneFlow, AStatueIsOfMarbleWithoutHair) {
    auto device = cpu();
    Result<std::unique_ptr<Session>> session = Session::create(crying({"flow.0.mapSize=64"}, "rain on a statue"), *device, {});
    ASSERT_TRUE(session) << session.error().message;
    size_t shown = 0;
    for (const Node& node : (*session)->solids().nodes()) {
        if (!node.mesh || !node.visible) continue;
        ++shown;
        EXPECT_TRUE(node.material.skin != nullptr && node.material.colour == nullptr) << node.name;
        EXPECT_FALSE(node.material.eye) << node.name;
        EXPECT_FALSE(node.name.starts_with("hair") || node.name.starts_with("lashes")) << node.name;
    }
    EXPECT_GE(shown, 3U) << "the skin and both eyes";
}

// A change of the look is seen at once, also while the run is paused.
TEST(SceneFlow, RednessIsAppliedWithoutAStep) {
    auto device = cpu();
    Result<std::unique_ptr<Session>> session = Session::create(crying({"flow.0.mapSize=64", "flow.0.redness=0"}), *device, {});
    ASSERT_TRUE(session) << session.error().message;
    const auto flush = [&] {
        float most = 0;
        for (const Node& node : (*session)->solids().nodes()) most = std::max(most, node.material.flush);
        return most;
    };
    EXPECT_EQ(flush(), 0.0F);
    SceneFile scene = (*session)->scene();
    scene.flow[0].redness = 0.8F;
    (*session)->apply(scene);
    EXPECT_GE(flush(), 0.4F) << "half of it is there at once";
    EXPECT_LE(flush(), 0.8F);
}

TEST(SceneFlow, ASliderThatIsNoParameterIsRefused) {
    const Result<SceneFile> scene = loadScene("crying", std::vector<std::string>{"sliders=flow[0].amout"});
    ASSERT_FALSE(scene);
    EXPECT_NE(scene.error().message.find("flow[0].amout"), std::string::npos) << scene.error().message;
    EXPECT_NE(scene.error().message.find("flow[0].amount"), std::string::npos) << scene.error().message;
}

// Each preset does what its name says within a few seconds.
TEST(SceneFlow, PresetsWetTheFace) {
    auto device = cpu();
    for (const char* preset : {"single tear", "sob", "sweat", "rain on a statue"}) {
        Result<std::unique_ptr<Session>> session = Session::create(crying({"flow.0.mapSize=64"}, preset), *device, {});
        ASSERT_TRUE(session) << session.error().message;
        for (int k = 0; k < 180; ++k) (*session)->step(1.0 / 60, true);
        size_t large = 0, all = 0;
        for (const SkinDrop& d : (*session)->flows().skins()[0]->flow().drops()) {
            large += d.volume > 3e-9 && d.way > 0.005 ? 1 : 0;
            all += d.volume > (std::string(preset) == "sweat" ? 1e-10 : 4e-10) ? 1 : 0;
        }
        if (std::string(preset) == "single tear")
            EXPECT_EQ(large, 1U);
        else if (std::string(preset) == "sob")
            EXPECT_GE(large, 1U);
        else
            EXPECT_GT(all, 50U) << preset;
        EXPECT_EQ((*session)->flows().ledger().error, 0.0) << preset;
    }
}

// Each preset of each scene with skins, to the picolitre: what was let out is on the skin, in the air, evaporated, or gone.
TEST(SceneFlow, NothingIsLostInAnyPreset) {
    auto device = cpu();
    size_t runs = 0;
    for (const char* name : {"crying", "cold_bottle", "window_rain"}) {
        const bool face = std::string(name) == "crying";
        const Result<SceneFile> scene = loadScene(name, {});
        ASSERT_TRUE(scene) << scene.error().message;
        std::vector<std::string> presets = {""};
        for (const PresetParams& preset : scene->presets) presets.push_back(preset.name);
        for (const std::string& preset : presets) {
            const Result<SceneFile> set =
                face ? crying({"flow.0.mapSize=64"}, preset) : loadScene(name, std::vector<std::string>{"flow.0.mapSize=64"}, preset);
            ASSERT_TRUE(set) << set.error().message;
            Result<std::unique_ptr<Session>> session = Session::create(*set, *device, {});
            ASSERT_TRUE(session) << session.error().message;
            for (int k = 0; k < 240; ++k) {
                (*session)->step(1.0 / 60, true);
                if (k % 40 == 39) EXPECT_EQ((*session)->flows().ledger().error, 0.0) << name << ", " << preset << ", step " << k;
            }
            EXPECT_GT((*session)->flows().ledger().emitted, 0.0) << name << ", " << preset;
            EXPECT_EQ((*session)->flows().skins()[0]->flow().refused(), 0U) << name << ", " << preset;
            ++runs;
        }
    }
    EXPECT_GE(runs, 11U);
}

// All edits that a panel permits: none ends the program, and an invalid one is reported once.
TEST(SceneFlow, APanelMayWriteAnything) {
    auto device = cpu();
    std::string said;
    Log log;
    log.sink = [&](LogLevel, std::string_view text) { said += std::string(text) + "|"; };
    for (const char* name : {"cold_bottle", "crying_thesis", "crying"}) {
        Result<SceneFile> scene = loadScene(name, std::vector<std::string>{"flow.0.mapSize=64"});
        ASSERT_TRUE(scene);
        Result<std::unique_ptr<Session>> session = Session::create(*scene, *device, log);
        ASSERT_TRUE(session) << session.error().message;
        SceneFile panel = *scene;
        panel.flow[0].sources.push_back({});
        const auto steps = [&] {
            (*session)->apply(panel);
            for (int k = 0; k < 4; ++k) (*session)->step(1.0 / 60, true);
            EXPECT_EQ((*session)->flows().ledger().error, 0.0) << name;
        };
        for (const char* kind : {"brim", "corner", "spot", "strewn", "rain"})
            for (const char* side : {"left", "right", "both"}) {
                for (FlowSourceParams& source : panel.flow[0].sources) {
                    source.kind = kind;
                    source.side = side;
                    source.rate = 3000;
                }
                steps();
            }
        panel.flow[0].mapSize = 777;
        panel.flow[0].mode = panel.flow[0].mode == "thesis" ? "drops" : "thesis";
        panel.flow[0].part = "none";
        panel.flow[0].liquid.advancing = 3;
        panel.flow[0].liquid.capacity = 7;
        steps();
        EXPECT_EQ((*session)->flows().skins()[0]->params().mode, scene->flow[0].mode);
        // Made anew with a source and an expression as they come out of a list's button.
        SceneFile more = *scene;
        more.flow[0].sources.push_back({});
        more.flow[0].expression.push_back({});
        const auto again = Session::create(more, *device, log);
        EXPECT_TRUE(again) << (again ? "" : again.error().message);
    }
    const size_t first = said.find("no marks of eyes");
    ASSERT_NE(first, std::string::npos) << said;
}

// As much as an eye may let out: brims spill larger tears, and not a picolitre is lost.
TEST(SceneFlow, AFloodOfTearsIsCounted) {
    auto device = cpu();
    Result<std::unique_ptr<Session>> session = Session::create(
        crying({"flow.0.sources.0.rate=1e5", "flow.0.sources.0.drop=20", "flow.0.mapSize=64", "flow.0.liquid.capacity=64"}), *device, {});
    ASSERT_TRUE(session) << session.error().message;
    for (int k = 0; k < 240; ++k) (*session)->step(1.0 / 60, true);
    EXPECT_EQ((*session)->flows().ledger().error, 0.0);
    EXPECT_GT((*session)->flows().ledger().emitted, 6e-6);
    EXPECT_FALSE(loadScene("crying", std::vector<std::string>{"flow.0.sources.0.drop=101"}));
    EXPECT_FALSE(Session::create(crying({"flow.0.sources.0.rate=1e6"}), *device, {}));
}

// A disc about a spot is as wide as was asked, along the skin.
TEST(SceneFlow, ASpotIsRound) {
    auto device = cpu();
    Result<SceneFile> scene =
        loadScene("window_rain", std::vector<std::string>{"flow.0.sources.0.kind=spot", "flow.0.sources.0.radius=0.05",
                                                          "flow.0.sources.0.position=0,0,0", "flow.0.sources.0.rate=100000",
                                                          "flow.0.sources.0.drop=0.5", "flow.0.liquid.hold=10", "flow.0.mapSize=64"});
    ASSERT_TRUE(scene) << scene.error().message;
    Result<std::unique_ptr<Session>> session = Session::create(*scene, *device, {});
    ASSERT_TRUE(session) << session.error().message;
    for (int k = 0; k < 10; ++k) (*session)->step(1.0 / 60, true);
    Bounds wide;
    for (const SkinDrop& d : (*session)->flows().skins()[0]->flow().drops()) wide.add(d.position);
    std::array<float, 3> size = {wide.size().x, wide.size().y, wide.size().z};
    std::sort(size.begin(), size.end());
    EXPECT_NEAR(size[1], 0.1F, 0.012F);
    EXPECT_NEAR(size[2], 0.1F, 0.012F);
}

}  // namespace
}  // namespace rivulet::scene_flow_test
