// A device is out of memory for a scene, or is lost during a run: the cpu continues, no water is lost, and one notice reports it.
#include "fluid/session/cpu_fallback.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "fluid/session/cooperation.h"
#include "fluid/session/run_stats.h"
#include "fluid/validate/physics_case.h"
#include "tests/parity/devices.h"

namespace rivulet::cpu_fallback_test {
namespace {

struct Said {
    std::vector<std::string> notices;
    Log log() {
        return {[this](LogLevel level, std::string_view text) {
            if (level == LogLevel::notice) notices.emplace_back(text);
        }};
    }
    size_t of(const std::string& word) const {
        return static_cast<size_t>(
            std::count_if(notices.begin(), notices.end(), [&](const std::string& s) { return s.find(word) != s.npos; }));
    }
};

// The dam break of MethodsParity: a frame is one step on every device.
SceneFile dam(const char* method) {
    SceneFile scene;
    scene.name = "dam";
    scene.fluid = parityDam(method);
    return scene;
}
constexpr double kFrame = 1.0 / 1600;  // s

std::unique_ptr<Device> clWith(const ClOptions& options) {
    auto made = makeClDevice(ShaderFiles::developer(), {}, options);
    return made ? std::move(*made) : nullptr;
}

struct Water {
    size_t particles = 0;
    double mass = 0, kinetic = 0;  // kg, J
    dvec3 centre{0.0};             // m
    double front = 0;              // m
};
Water waterOf(const FluidWorld& world) {
    const HostParticles all = readParticles(world);
    Water w;
    w.particles = all.position.size();
    for (size_t i = 0; i < all.position.size(); ++i) {
        const double m = all.mass[i];
        w.mass += m;
        w.centre += m * dvec3(all.position[i]);
        w.kinetic += 0.5 * m * glm::dot(dvec3(all.velocity[i]), dvec3(all.velocity[i]));
    }
    w.centre /= w.mass;
    w.front = bulkFront(all.position, world.params().box, world.params().spacing).value_or(0);
    return w;
}

// As MethodsParity asks of a run that nobody disturbed.
void expectAlike(const Water& there, const Water& here) {
    EXPECT_EQ(there.particles, here.particles);
    EXPECT_DOUBLE_EQ(there.mass, here.mass);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(there.centre[k] / here.centre[k], 1.0, 0.01) << k;
    EXPECT_NEAR(there.kinetic / here.kinetic, 1.0, 0.01);
    EXPECT_NEAR(there.front / here.front, 1.0, 0.01);
}

Water undisturbed(const SceneFile& scene, int frames) {
    const std::unique_ptr<Device> cpu = makeTestCpu();
    auto session = Session::create(scene, *cpu, {});
    EXPECT_TRUE(session);
    for (int k = 0; k < frames; ++k) (*session)->step(kFrame, true);
    return waterOf((*session)->world());
}

// By id: xyz and w.
std::vector<vec4> byId(const FluidWorld& world, const Buffer& buffer) {
    const uint32_t n = world.particles().slots;
    const std::vector<vec4> values = world.device().readAll<vec4>(buffer, n);
    const std::vector<uint32_t> id = world.device().readAll<uint32_t>(*world.particles().id, n);
    std::vector<vec4> sorted(n);
    for (uint32_t i = 0; i < n; ++i) sorted[id[i]] = values[i];
    return sorted;
}

class CpuFallback : public testing::Test {
  protected:
    void SetUp() override {
        if (const Result<TestGpu> gpu = makeTestGpu("cl"); !gpu) GTEST_SKIP() << gpu.error().message;
    }
    Said said_;
};

TEST_F(CpuFallback, NoMemoryWhenASceneIsOpened) {
    const SceneFile scene = dam("wcsph");
    const std::unique_ptr<Device> small = clWith({.memoryLimit = size_t{100} << 10U});
    auto opened = openSession(scene, *small, said_.log());
    ASSERT_TRUE(opened) << opened.error().message;
    ASSERT_TRUE(opened->instead);
    EXPECT_EQ(opened->instead->backend(), Backend::cpu);
    EXPECT_EQ(&opened->session->world().device(), opened->instead.get());
    EXPECT_EQ(small->bytesAllocated(), 0U);
    EXPECT_EQ(said_.of("the cpu simulates"), 1U);
    EXPECT_EQ(said_.of("out of memory"), 1U);
    opened->session->step(kFrame, true);
    EXPECT_EQ(waterOf(opened->session->world()).particles, 8192U);
}

TEST_F(CpuFallback, ADeviceThatWorksIsLeftAlone) {
    std::unique_ptr<Device> device = clWith({});
    const Device* was = device.get();
    auto opened = openSession(dam("wcsph"), *device, said_.log());
    ASSERT_TRUE(opened);
    EXPECT_FALSE(opened->instead);
    for (int k = 0; k < 3; ++k) {
        opened->session->step(kFrame, true);
        EXPECT_FALSE(*keepRunning(*opened->session, device, said_.log()));
    }
    EXPECT_EQ(device.get(), was);
    EXPECT_TRUE(said_.notices.empty());
}

// An invalid scene is reported as such, and not as a failure of the device.
TEST_F(CpuFallback, ErrorsOfASceneAreReportedAsOnAnyDevice) {
    SceneFile scene = dam("wcsph");
    scene.fluid.method = "none";
    const std::unique_ptr<Device> device = clWith({});
    const auto opened = openSession(scene, *device, said_.log());
    ASSERT_FALSE(opened);
    EXPECT_EQ(opened.error().fault, Fault::badInput);
    EXPECT_TRUE(said_.notices.empty());
}

TEST_F(CpuFallback, NoMemoryMidway) {
    const SceneFile scene = dam("wcsph");
    size_t needed = 0;
    {
        const std::unique_ptr<Device> roomy = clWith({});
        auto session = Session::create(scene, *roomy, {});
        ASSERT_TRUE(session);
        (*session)->step(kFrame, true);
        needed = roomy->bytesAllocated();
    }
    std::unique_ptr<Device> device = clWith({.memoryLimit = needed + 1000});
    auto opened = openSession(scene, *device, said_.log());
    ASSERT_TRUE(opened);
    ASSERT_FALSE(opened->instead);
    Session& session = *opened->session;
    for (int k = 0; k < 50; ++k) {
        session.step(kFrame, true);
        ASSERT_FALSE(*keepRunning(session, device, said_.log()));
    }
    // A pass that wants memory of its own.
    SceneFile more = scene;
    more.fluid.forces.normals = "thesis";
    session.apply(more);
    session.step(kFrame, true);
    ASSERT_EQ(device->health().state, DeviceHealth::full);
    const std::vector<vec4> x = byId(session.world(), *session.world().particles().position),
                            v = byId(session.world(), *session.world().particles().velocity);
    const double then = session.world().time();
    ASSERT_TRUE(*keepRunning(session, device, said_.log()));
    // What the device still held is what the cpu has, to the bit.
    EXPECT_EQ(device->backend(), Backend::cpu);
    EXPECT_EQ(&session.world().device(), device.get());
    EXPECT_EQ(session.world().time(), then);
    EXPECT_EQ(byId(session.world(), *session.world().particles().position), x);
    EXPECT_EQ(byId(session.world(), *session.world().particles().velocity), v);
    EXPECT_EQ(said_.of("the cpu continues"), 1U);
    for (int k = 51; k < 200; ++k) {
        session.step(kFrame, true);
        EXPECT_FALSE(*keepRunning(session, device, said_.log()));
    }
    EXPECT_NE(session.world().particles().normal, nullptr) << "what there was no memory for is there now";
    EXPECT_EQ(said_.of("the cpu continues"), 1U);
    expectAlike(waterOf(session.world()), undisturbed(scene, 200));
}

class CpuFallbackOf : public CpuFallback, public testing::WithParamInterface<const char*> {};

TEST_P(CpuFallbackOf, LostMidway) {
    const SceneFile scene = dam(GetParam());
    // Lost in the middle of a step, after some eighty of them.
    std::unique_ptr<Device> device = clWith({.failAfter = 1501});
    auto opened = openSession(scene, *device, said_.log());
    ASSERT_TRUE(opened);
    ASSERT_FALSE(opened->instead);
    Session& session = *opened->session;
    double lostAt = 0, from = 0;
    for (int guard = 0; session.world().time() < 200 * kFrame - 1.0e-9; ++guard) {
        ASSERT_LT(guard, 1000);
        session.step(kFrame, true);
        const double reached = session.world().time();
        const Result<bool> moved = keepRunning(session, device, said_.log());
        ASSERT_TRUE(moved) << moved.error().message;
        if (!*moved) continue;
        EXPECT_EQ(lostAt, 0.0) << "once";
        lostAt = reached;
        from = session.world().time();
        EXPECT_EQ(waterOf(session.world()).particles, 8192U);
    }
    EXPECT_GT(lostAt, 0.0);
    EXPECT_GT(from, 0.0) << "from a snapshot, not from the start";
    EXPECT_LT(from, lostAt);
    EXPECT_EQ(device->backend(), Backend::cpu);
    EXPECT_EQ(said_.of("the cpu continues"), 1U);
    const std::string notice =
        *std::find_if(said_.notices.begin(), said_.notices.end(), [](const auto& s) { return s.find("continues") != s.npos; });
    char expected[32];
    std::snprintf(expected, sizeof expected, "from %.3f s", from);
    EXPECT_NE(notice.find(expected), std::string::npos) << notice;
    EXPECT_NE(notice.find("CL_DEVICE_NOT_AVAILABLE"), std::string::npos) << notice;
    EXPECT_NEAR(session.world().time(), 200 * kFrame, 1.0e-9);
    expectAlike(waterOf(session.world()), undisturbed(scene, 200));
    RecordProperty("back", std::to_string((lostAt - from) / kFrame));
}

INSTANTIATE_TEST_SUITE_P(Methods, CpuFallbackOf, testing::Values("wcsph", "pbf", "dfsph"),
                         [](const auto& row) { return std::string(row.param); });

TEST_F(CpuFallback, LostBeforeTheFirstSnapshot) {
    const SceneFile scene = dam("wcsph");
    std::unique_ptr<Device> device = clWith({.failAfter = 3});
    auto opened = openSession(scene, *device, said_.log());
    ASSERT_TRUE(opened);
    ASSERT_FALSE(opened->instead);
    opened->session->step(kFrame, true);
    ASSERT_TRUE(*keepRunning(*opened->session, device, said_.log()));
    EXPECT_EQ(opened->session->world().time(), 0.0);
    const Water water = waterOf(opened->session->world());
    EXPECT_EQ(water.particles, 8192U);
    EXPECT_NEAR(water.centre.y, 0.5, 1.0e-3);
    EXPECT_EQ(water.kinetic, 0.0);
    EXPECT_EQ(said_.of("from 0.000 s"), 1U);
}

// The thesis's lists are a GPU's: the cpu goes on sorted, from where each particle was.
SceneFile linked() {
    SceneFile scene = dam("wcsph_thesis");
    scene.fluid.grid = "linked_list";
    return scene;
}

TEST_F(CpuFallback, LinkedListsContinueSorted) {
    SceneFile sorted = linked();
    sorted.fluid.grid = "sorted";
    const Water calm = undisturbed(sorted, 200);
    {
        std::unique_ptr<Device> device = clWith({.failAfter = 801});
        auto opened = openSession(linked(), *device, said_.log(), "cl");
        ASSERT_TRUE(opened) << opened.error().message;
        ASSERT_FALSE(opened->instead);
        Session& session = *opened->session;
        int moves = 0;
        for (int guard = 0; session.world().time() < 200 * kFrame - 1.0e-9; ++guard) {
            ASSERT_LT(guard, 1000);
            session.step(kFrame, true);
            const Result<bool> moved = keepRunning(session, device, said_.log());
            ASSERT_TRUE(moved) << moved.error().message;
            moves += *moved ? 1 : 0;
        }
        EXPECT_EQ(moves, 1);
        EXPECT_EQ(session.scene().fluid.grid, "sorted");
        EXPECT_EQ(session.world().params().grid, "sorted");
        EXPECT_EQ(said_.notices.size(), 1U);
        EXPECT_EQ(said_.of("fluid.grid is sorted"), 1U);
        expectAlike(waterOf(session.world()), calm);
        session.reset();
        session.step(kFrame, true);
        EXPECT_EQ(session.world().stats().nan, 0U);
    }
    // A device without free memory keeps its data bit for bit.
    const std::unique_ptr<Device> cpu = makeTestCpu();
    std::unique_ptr<Device> device = clWith({});
    auto opened = openSession(linked(), *device, said_.log(), "cl");
    ASSERT_TRUE(opened);
    Session& session = *opened->session;
    for (int k = 0; k < 20; ++k) session.step(kFrame, true);
    const std::vector<vec4> x = byId(session.world(), *session.world().particles().position),
                            v = byId(session.world(), *session.world().particles().velocity);
    const Status moved = session.moveTo(*cpu);
    ASSERT_TRUE(moved) << moved.error().message;
    EXPECT_EQ(byId(session.world(), *session.world().particles().position), x);
    EXPECT_EQ(byId(session.world(), *session.world().particles().velocity), v);
}

TEST_F(CpuFallback, LinkedListsWithoutMemoryAreSorted) {
    const std::unique_ptr<Device> small = clWith({.memoryLimit = size_t{100} << 10U});
    auto opened = openSession(linked(), *small, said_.log(), "cl");
    ASSERT_TRUE(opened) << opened.error().message;
    ASSERT_TRUE(opened->instead);
    EXPECT_EQ(opened->session->scene().fluid.grid, "sorted");
    EXPECT_EQ(said_.notices.size(), 1U);
    EXPECT_EQ(said_.of("fluid.grid is sorted"), 1U);
}

// The cpu replaces an absent GPU and sorts the particles instead. If a scene selects the cpu itself, linked lists are refused.
TEST(CpuFallbackWithoutGpu, AnAbsentGpuLeavesLinkedListsSorted) {
    const std::unique_ptr<Device> cpu = makeTestCpu();
    for (const char* asked : {"gl", "cl", "auto"}) {
        Said said;
        auto opened = openSession(linked(), *cpu, said.log(), asked);
        ASSERT_TRUE(opened) << opened.error().message;
        EXPECT_FALSE(opened->instead);
        EXPECT_EQ(opened->session->scene().fluid.grid, "sorted");
        EXPECT_EQ(said.notices.size(), 1U);
        EXPECT_EQ(said.of("fluid.grid is sorted"), 1U);
    }
    Said said;
    auto refused = openSession(linked(), *cpu, said.log(), "cpu");
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().fault, Fault::badInput);
    EXPECT_TRUE(said.notices.empty());
}

// A frame budget tries settings. A setting that is too large for the device is left out, and the device continues with another.
TEST_F(CpuFallback, ABudgetsTrialThatIsTooLargeLeavesTheDeviceUsable) {
    const auto needs = [&](const char* method, float spacing) {
        SceneFile scene = dam(method);
        scene.fluid.spacing = spacing;
        const std::unique_ptr<Device> roomy = clWith({});
        auto session = Session::create(scene, *roomy, {});
        EXPECT_TRUE(session);
        for (int k = 0; k < 3; ++k) (*session)->step(1.0 / 60, true);
        return roomy->bytesAllocated();
    };
    SceneFile scene = dam("dfsph");
    scene.fluid.spacing = 0.05F;
    scene.budget.frameMs = 1.0e6F;  // so large that only memory decides, on any machine
    scene.budget.maxDensityError = 0.05F;
    // With smoothing, pbf needs more memory per particle than dfsph.
    const size_t pbf = needs("pbf", scene.fluid.spacing), dfsph = needs("dfsph", scene.fluid.spacing);
    ASSERT_GT(static_cast<double>(pbf), 1.02 * static_cast<double>(dfsph));
    std::unique_ptr<Device> device = clWith({.memoryLimit = (pbf + dfsph) / 2});
    auto opened = openSession(scene, *device, said_.log());
    ASSERT_TRUE(opened) << opened.error().message;
    EXPECT_FALSE(opened->instead) << "the cpu is not needed";
    EXPECT_EQ(device->health().state, DeviceHealth::works) << device->health().why;
    EXPECT_EQ(opened->session->world().params().method, "dfsph");
    EXPECT_EQ(said_.of("the cpu"), 0U);
    for (int k = 0; k < 3; ++k) {
        opened->session->step(1.0 / 60, true);
        EXPECT_FALSE(*keepRunning(*opened->session, device, said_.log()));
    }
    // As many particles as fit into memory.
    opened->session.reset();
    SceneFile fine = scene;
    fine.fluid.spacing = 0.5F * scene.fluid.spacing;
    opened = openSession(fine, *device, said_.log());
    ASSERT_TRUE(opened) << opened.error().message;
    EXPECT_FALSE(opened->instead) << said_.notices.back();
    EXPECT_EQ(device->health().state, DeviceHealth::works) << device->health().why;
    EXPECT_GT(opened->session->scene().fluid.spacing, fine.fluid.spacing);
    EXPECT_GT(opened->session->world().particles().count, 1000U);
}

// Results of a failed device are not reported as measurements.
TEST_F(CpuFallback, ACaseOnADeviceThatFailsIsAnError) {
    const std::unique_ptr<Device> cpu = makeTestCpu();
    CaseSettings settings;
    settings.quick = true;
    settings.assignments = {"fluid.spacing=0.07", "duration=0.1"};
    for (const bool compared : {true, false}) {
        const std::unique_ptr<Device> lost = clWith({.failAfter = 300}), works = clWith({});
        settings.device = lost.get();
        const Result<Outcome> none = runCase(*physicsCases().find("momentum"), settings, compared ? cpu.get() : nullptr);
        ASSERT_FALSE(none);
        EXPECT_EQ(none.error().fault, Fault::failed);
        EXPECT_NE(none.error().message.find("results are invalid"), std::string::npos) << none.error().message;
        settings.device = works.get();
        const Result<Outcome> some = runCase(*physicsCases().find("momentum"), settings, compared ? cpu.get() : nullptr);
        ASSERT_TRUE(some) << some.error().message;
        EXPECT_FALSE(some->findings.empty());
    }
}

// A complete headless run that steps, draws and records each frame while the cpu finds cells; the device fails midway.
TEST_F(CpuFallback, ARunReachesItsEndWhateverFails) {
    const SceneFile scene = dam("wcsph");
    const Water calm = undisturbed(scene, 120);
    for (const ClOptions& fault : {ClOptions{.failAfter = 901}, ClOptions{.eventFailsAfter = 901}}) {
        SCOPED_TRACE(fault.failAfter);
        Said said;
        Timeline timeline;
        std::unique_ptr<Device> device = clWith(fault);
        auto opened = openSession(scene, *device, said.log(), "cl");
        ASSERT_TRUE(opened);
        ASSERT_FALSE(opened->instead);
        Session& session = *opened->session;
        traceKernels(*device, timeline);
        Cooperation work(session, Plan::thesis, &timeline, said.log());
        RunRecorder recorder(session.world(), session.fields(), true);
        int frames = 0, moves = 0;
        bool helped = false;
        for (; session.world().time() < 120 * kFrame - 1.0e-9; ++frames) {
            ASSERT_LT(frames, 1000);
            const double ms = work.started() ? work.finish() : work.step(kFrame, true);
            const Result<bool> moved = keepRunning(session, device, said.log());
            ASSERT_TRUE(moved) << moved.error().message;
            if (*moved) {
                ++moves;
                recorder.follow(session.world());
                traceKernels(*device, timeline);
            }
            recorder.stepped(ms, device->takeTimes());
            if (session.world().time() < 119 * kFrame - 1.0e-9) work.start(kFrame, true);
            recorder.drawn(0, ms, {});
            helped = helped || work.helped();
        }
        work.drop();
        EXPECT_EQ(moves, 1);
        EXPECT_TRUE(helped);
        EXPECT_EQ(said.of("the cpu continues"), 1U);
        EXPECT_EQ(said.of("--cooperate thesis"), 1U);
        EXPECT_EQ(said.notices.size(), 2U);
        const RunStats stats = recorder.finish("dam");
        EXPECT_EQ(stats.backend, "cpu");
        EXPECT_EQ(stats.frames, static_cast<uint64_t>(frames));
        EXPECT_NEAR(stats.seconds, 120 * kFrame, 1.0e-9);
        EXPECT_EQ(stats.particles, 8192U);
        EXPECT_EQ(stats.lost, 0U);
        EXPECT_EQ(stats.nan, 0U);
        EXPECT_EQ(work.stats().plan, "off");
        expectAlike(waterOf(session.world()), calm);
        std::set<std::string> lanes;
        for (const Timeline::Lane& lane : timeline.lanes()) lanes.insert(lane.name);
        EXPECT_TRUE(lanes.contains("cl: kernels"));
        EXPECT_TRUE(lanes.contains("cpu: kernels"));
    }
}

// All other parts of a scene: bodies, moving and deforming colliders, emitters and sinks.
TEST_F(CpuFallback, SolidsBodiesAndSourcesContinue) {
    const auto lively = [](const std::vector<std::string>& more) {
        std::vector<std::string> set = {"fluid.spacing=0.025",       "colliders.0.resolution=32",       "fluid.foam.most=500",
                                        "bodies.0.size=0.1,0.1,0.1", "bodies.0.position=0.15,0.25,0.2", "emitters.0.position=0.8,0.6,0.2",
                                        "emitters.0.speed=1"};
        set.insert(set.end(), more.begin(), more.end());
        auto scene = loadScene("paddle_wheel", set);
        EXPECT_TRUE(scene) << (scene ? "" : scene.error().message);
        return scene ? *scene : SceneFile{};
    };
    const auto bending = [] {
        auto scene = loadScene("waving_sheet", std::vector<std::string>{"fluid.spacing=0.05", "colliders.0.resolution=24"});
        EXPECT_TRUE(scene) << (scene ? "" : scene.error().message);
        return scene ? *scene : SceneFile{};
    };
    for (const SceneFile& scene : {lively({}), bending()}) {
        SCOPED_TRACE(scene.name);
        const std::unique_ptr<Device> cpu = makeTestCpu();
        std::unique_ptr<Device> device = clWith({});
        auto opened = openSession(scene, *device, said_.log());
        ASSERT_TRUE(opened) << opened.error().message;
        Session& session = *opened->session;
        const std::vector<vec3> shape = session.solids().nodes()[0].mesh->positions;
        for (int k = 0; k < 12; ++k) session.step(1.0 / 60, true);
        const FluidWorld* before = &session.world();
        ASSERT_EQ(before->bodies().size(), scene.bodies.size());
        ASSERT_FALSE(before->poses().empty() && session.fields().deforming.empty());
        const double then = before->time();
        const std::vector<vec4> x = byId(*before, *before->particles().position);
        const std::vector<Pose> poses = before->poses();
        const std::vector<BodyState> bodies = before->bodies();
        const uint64_t there = static_cast<uint64_t>(waterOf(*before).particles);
        const Bounds bounds = session.bounds();
        const Status moved = session.moveTo(*cpu);
        ASSERT_TRUE(moved) << moved.error().message;
        device.reset();  // no longer in use
        EXPECT_EQ(session.world().time(), then);
        EXPECT_EQ(byId(session.world(), *session.world().particles().position), x);
        EXPECT_EQ(waterOf(session.world()).particles, there);
        ASSERT_EQ(session.world().poses().size(), poses.size());
        for (size_t k = 0; k < poses.size(); ++k) EXPECT_EQ(session.world().poses()[k].rotation, poses[k].rotation);
        ASSERT_EQ(session.world().bodies().size(), bodies.size());
        for (size_t k = 0; k < bodies.size(); ++k) {
            EXPECT_EQ(session.world().bodies()[k].pose.position, bodies[k].pose.position);
            EXPECT_EQ(session.world().bodies()[k].velocity, bodies[k].velocity);
        }
        EXPECT_EQ(session.bounds().min, bounds.min);
        EXPECT_EQ(session.bounds().max, bounds.max);
        for (int k = 0; k < 12; ++k) session.step(1.0 / 60, true);
        EXPECT_NEAR(session.world().time(), then + 0.2, 1.0e-9);
        EXPECT_GE(waterOf(session.world()).particles, there);
        EXPECT_EQ(session.world().stats().nan, 0U);
        session.reset();
        EXPECT_EQ(session.world().time(), 0.0);
        EXPECT_EQ(session.solids().nodes()[0].mesh->positions, shape) << "the start is the scene's, not where the cpu took over";
    }
}

// Drops on a skin, in its brims and in the air: their number and positions stay the same.
TEST_F(CpuFallback, FlowsOnSkinsContinue) {
    auto scene = loadScene(
        "window_rain",
        std::vector<std::string>{"flow.0.mapSize=64", "flow.0.liquid.capacity=2048", "flow.0.liquid.filmCell=0.003",
                                 "flow.0.sources.1.kind=rain", "flow.0.sources.1.rate=20000", "flow.0.sources.1.speed=3",
                                 "flow.0.liquid.evaporation=0.00001", "flow.0.sources.0.drop=40", "flow.0.sources.0.rate=400000"});
    ASSERT_TRUE(scene) << scene.error().message;
    const auto dropsOf = [](Session& s) {
        std::vector<SkinDrop> drops = s.flows().skins()[0]->flow().drops();
        std::sort(drops.begin(), drops.end(), [](const SkinDrop& a, const SkinDrop& b) { return a.id < b.id; });
        return drops;
    };
    const std::unique_ptr<Device> cpu = makeTestCpu();
    std::unique_ptr<Device> device = clWith({});
    auto opened = openSession(*scene, *device, said_.log());
    ASSERT_TRUE(opened) << opened.error().message;
    Session& session = *opened->session;
    for (int k = 0; k < 20; ++k) session.step(1.0 / 60, true);
    const std::vector<SkinDrop> before = dropsOf(session);
    const SkinFlows::Ledger then = session.flows().ledger();
    const size_t inAir = session.flows().inAir();
    ASSERT_GT(before.size(), 20U);
    ASSERT_GT(inAir, 0U);
    ASSERT_GT(then.evaporated, 0.0);
    EXPECT_EQ(then.error, 0.0);
    const Status moved = session.moveTo(*cpu);
    ASSERT_TRUE(moved) << moved.error().message;
    device.reset();
    const std::vector<SkinDrop> after = dropsOf(session);
    ASSERT_EQ(after.size(), before.size());
    for (size_t k = 0; k < before.size(); ++k) {
        EXPECT_EQ(after[k].id, before[k].id);
        EXPECT_EQ(after[k].volume, before[k].volume);
        EXPECT_LT(glm::distance(after[k].position, before[k].position), 1.0e-6F);
        EXPECT_EQ(after[k].velocity, before[k].velocity);
    }
    const SkinFlows::Ledger now = session.flows().ledger();
    EXPECT_EQ(now.emitted, then.emitted);
    EXPECT_EQ(now.onSurface, then.onSurface);
    EXPECT_EQ(now.inAir, then.inAir);
    EXPECT_EQ(now.evaporated, then.evaporated);
    EXPECT_EQ(now.drained, then.drained);
    EXPECT_EQ(now.error, 0.0);
    EXPECT_EQ(session.flows().inAir(), inAir);

    // After that no volume is lost, and the emitted volume equals that of an undisturbed run.
    const std::unique_ptr<Device> other = makeTestCpu();
    auto calm = Session::create(*scene, *other, {});
    ASSERT_TRUE(calm);
    for (int k = 0; k < 40; ++k) (*calm)->step(1.0 / 60, true);
    for (int k = 0; k < 20; ++k) session.step(1.0 / 60, true);
    const SkinFlows::Ledger end = session.flows().ledger(), calmEnd = (*calm)->flows().ledger();
    EXPECT_EQ(end.error, 0.0);
    EXPECT_EQ(end.emitted, calmEnd.emitted);
    EXPECT_NEAR(end.onSurface / calmEnd.onSurface, 1.0, 0.01);
}

// If the device of a skin is lost, the run returns to a snapshot, and no volume is lost.
TEST_F(CpuFallback, FlowsOnSkinsWhenADeviceIsLost) {
    auto scene = loadScene("window_rain",
                           std::vector<std::string>{"flow.0.mapSize=64", "flow.0.liquid.capacity=2048", "flow.0.liquid.filmCell=0.003"});
    ASSERT_TRUE(scene) << scene.error().message;
    std::unique_ptr<Device> device = clWith({.failAfter = 700});
    auto opened = openSession(*scene, *device, said_.log());
    ASSERT_TRUE(opened) << opened.error().message;
    Session& session = *opened->session;
    int moves = 0;
    for (int k = 0; k < 60; ++k) {
        session.step(1.0 / 60, true);
        const Result<bool> moved = keepRunning(session, device, said_.log());
        ASSERT_TRUE(moved) << moved.error().message;
        moves += *moved ? 1 : 0;
    }
    EXPECT_EQ(moves, 1);
    EXPECT_EQ(said_.of("the cpu continues"), 1U);
    const SkinFlows::Ledger end = session.flows().ledger();
    EXPECT_EQ(end.error, 0.0);
    EXPECT_GT(end.onSurface, 0.0);
}

}  // namespace
}  // namespace rivulet::cpu_fallback_test
