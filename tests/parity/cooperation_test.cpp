// Cooperation: the result is the same with every plan, and a plan that overlaps work does so.
#include "fluid/session/autotune.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <thread>

#include "engine/compute/device_cl.h"
#include "tests/parity/devices.h"

namespace rivulet::cooperation_test {
namespace {

SceneFile dam(const char* method = "wcsph") {
    SceneFile scene;
    scene.name = "dam";
    scene.fluid.method = method;
    scene.fluid.spacing = 0.04F;
    scene.fluid.box.max = vec3(1.0F, 1.2F, 1.0F);
    scene.fluid.blocks = {{vec3(0.0F), vec3(0.5F, 0.8F, 0.5F), vec3(0.0F)}};
    return scene;
}

struct Said {
    std::vector<std::string> notices;
    Log log() {
        return {[this](LogLevel level, std::string_view text) {
            if (level >= LogLevel::notice) notices.emplace_back(text);
        }};
    }
};

// Returns the particles by id after a number of frames; `meanwhile` is called between steps.
std::vector<vec4> after(
    int frames, const SceneFile& scene, Device& device, Plan plan, Timeline* timeline = nullptr,
    const std::function<void(Session&)>& meanwhile = [](Session&) {}, const Log& log = {}) {
    auto session = Session::create(scene, device, {});
    EXPECT_TRUE(session);
    Cooperation work(**session, plan, timeline, log);
    for (int f = 0; f < frames; ++f) {
        if (!work.started()) work.start(1.0 / 240, true);
        work.finish();
        if (f + 1 < frames) work.start(1.0 / 240, true);
        meanwhile(**session);
    }
    work.drop();
    const HostParticles all = readParticles((*session)->world());
    std::vector<vec4> byId(all.position.size());
    for (size_t i = 0; i < byId.size(); ++i) byId[all.id[i]] = all.position[i];
    return byId;
}

class CooperationOn : public testing::TestWithParam<const char*> {};

TEST_P(CooperationOn, CellsFoundOnTheCpuEqualThoseOfTheDevice) {
    const Result<TestGpu> gpu = makeTestGpu(GetParam());
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    for (const char* method : {"wcsph", "wcsph_thesis", "dfsph"}) {
        SCOPED_TRACE(method);
        const SceneFile scene = dam(method);
        Timeline timeline;
        const std::vector<vec4> alone = after(8, scene, *gpu->device, Plan::alone);
        const std::vector<vec4> thesis = after(8, scene, *gpu->device, Plan::thesis, &timeline);
        EXPECT_EQ(alone, thesis) << "to the bit";
        size_t found = 0;
        for (const Timeline::Lane& lane : timeline.lanes())
            for (const PassSpan& span : lane.spans) found += span.name == "cell_of" ? 1 : 0;
        EXPECT_EQ(found, 7U) << "before each step but the first";
        bool given = false;
        for (const std::string& kernel : gpu->device->kernels()) given |= kernel.find("cell_count;GIVEN=1") != kernel.npos;
        EXPECT_TRUE(given);
    }
}

// Cells are invalid after the particles have moved.
TEST_P(CooperationOn, CellsOfAWorldThatWasResetAreNotUsed) {
    const Result<TestGpu> gpu = makeTestGpu(GetParam());
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    const SceneFile scene = dam();
    int frame = 0;
    const auto meanwhile = [&](Session& session) {
        if (++frame == 6) session.world().reset();
    };
    const std::vector<vec4> anew = after(9, scene, *gpu->device, Plan::thesis, nullptr, meanwhile);
    EXPECT_EQ(anew, after(3, scene, *gpu->device, Plan::alone));
}

TEST_P(CooperationOn, AMethodThatMovesBeforeItSortsGetsANotice) {
    const Result<TestGpu> gpu = makeTestGpu(GetParam());
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    const SceneFile scene = dam("pbf");
    Said said;
    const std::vector<vec4> thesis = after(
        6, scene, *gpu->device, Plan::thesis, nullptr, [](Session&) {}, said.log());
    EXPECT_EQ(thesis, after(6, scene, *gpu->device, Plan::alone));
    ASSERT_EQ(said.notices.size(), 1U);
    EXPECT_NE(said.notices[0].find("pbf"), std::string::npos) << said.notices[0];
}

// A plan that has no work to overlap is not reported as the active plan.
TEST_P(CooperationOn, APlanWithNothingToDoBecomesAlone) {
    const Result<TestGpu> gpu = makeTestGpu(GetParam());
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    SceneFile bodies = dam(), linked = dam("wcsph_thesis");
    bodies.bodies.emplace_back();
    bodies.bodies[0].size = vec3(0.2F);
    bodies.bodies[0].position = vec3(0.7F, 0.4F, 0.5F);
    linked.fluid.grid = "linked_list";
    for (const SceneFile& scene : {dam("pbf"), bodies, linked}) {
        Said said;
        Timeline timeline;
        auto session = Session::create(scene, *gpu->device, {});
        ASSERT_TRUE(session) << session.error().message;
        Cooperation work(**session, Plan::thesis, &timeline, said.log());
        EXPECT_EQ(work.plan(), Plan::alone);
        EXPECT_EQ(work.stats().plan, "off");
        EXPECT_EQ(said.notices.size(), 1U);
    }
}

// After a fallback to the cpu the plan is alone.
TEST_P(CooperationOn, AfterAFallbackThePlanIsAlone) {
    const Result<TestGpu> gpu = makeTestGpu(GetParam());
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    const std::unique_ptr<Device> cpu = makeTestCpu();
    Said said;
    Timeline timeline;
    auto session = Session::create(dam(), *gpu->device, {});
    ASSERT_TRUE(session);
    Cooperation work(**session, Plan::thesis, &timeline, said.log());
    for (int f = 0; f < 4; ++f) {
        work.start(1.0 / 240, true);
        work.finish();
    }
    EXPECT_TRUE(work.helped());
    EXPECT_EQ(work.stats().plan, "thesis");
    EXPECT_TRUE(said.notices.empty());
    ASSERT_TRUE((*session)->moveTo(*cpu));
    for (int f = 0; f < 3; ++f) {
        work.start(1.0 / 240, true);
        work.finish();
    }
    EXPECT_EQ(work.plan(), Plan::alone);
    EXPECT_EQ(work.stats().plan, "off");
    EXPECT_EQ(said.notices.size(), 1U);
}

// A step without concurrent drawing reads nothing back for the cells.
TEST_P(CooperationOn, AStepAloneReadsNothingBack) {
    const Result<TestGpu> gpu = makeTestGpu(GetParam());
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    Timeline timeline;
    auto session = Session::create(dam(), *gpu->device, {});
    ASSERT_TRUE(session);
    Cooperation work(**session, Plan::thesis, &timeline, {});
    for (int f = 0; f < 4; ++f) work.step(1.0 / 240, true);
    for (const Timeline::Lane& lane : timeline.lanes())
        for (const PassSpan& span : lane.spans) EXPECT_EQ(span.name, "step") << lane.name;
    EXPECT_FALSE(work.helped());
}

TEST_P(CooperationOn, SteppingInTheBackgroundIsForTheCpu) {
    const Result<TestGpu> gpu = makeTestGpu(GetParam());
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    Said said;
    auto session = Session::create(dam(), *gpu->device, {});
    ASSERT_TRUE(session);
    EXPECT_EQ(Cooperation(**session, Plan::behind, nullptr, said.log()).plan(), Plan::alone);
    ASSERT_EQ(said.notices.size(), 1U);
}

INSTANTIATE_TEST_SUITE_P(Devices, CooperationOn, testing::Values("cl", "gl"),
                         [](const testing::TestParamInfo<const char*>& which) { return std::string(which.param); });

TEST(CooperationOfTheCpu, StepsWhileAnotherWorks) {
    const std::unique_ptr<Device> cpu = makeTestCpu();
    const SceneFile scene = dam("pbf");
    Timeline timeline;
    const std::vector<vec4> alone = after(12, scene, *cpu, Plan::alone);
    const std::vector<vec4> behind = after(12, scene, *cpu, Plan::behind, &timeline, [&](Session&) {
        const TimedSpan span(&timeline, kDrawingLane, "a picture");
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    });
    EXPECT_EQ(alone, behind) << "to the bit";
    std::vector<PassSpan> steps, pictures;
    for (const Timeline::Lane& lane : timeline.lanes()) {
        if (lane.name == "cpu: ahead") steps = lane.spans;
        if (lane.name == kDrawingLane) pictures = lane.spans;
    }
    ASSERT_EQ(steps.size(), 12U);
    double worked = 0;
    for (const PassSpan& step : std::span(steps).subspan(1)) worked += step.end - step.begin;  // the first has no picture to overlap
    EXPECT_GT(overlapSeconds(steps, pictures), 0.1 * worked);
}

// Means cover the frames that the timeline still holds, of the session's own work only.
TEST(CooperationOfTheCpu, FiguresAreOfTheFramesThatTheTimelineHolds) {
    const std::unique_ptr<Device> cpu = makeTestCpu();
    Timeline timeline(24);
    const auto run = [&](int frames) {
        auto session = Session::create(dam("pbf"), *cpu, {});
        EXPECT_TRUE(session);
        Cooperation work(**session, Plan::behind, &timeline, {});
        EXPECT_EQ(work.stats().aheadMs, 0) << "work of another session does not count";
        const double begun = hostSeconds();
        for (int f = 0; f < frames; ++f) {
            work.start(1.0 / 240, true);
            {
                const TimedSpan span(&timeline, kDrawingLane, "a picture");
                std::this_thread::sleep_for(std::chrono::milliseconds(2));
            }
            work.finish();
        }
        double shortest = 1e9, longest = 0;
        for (const Timeline::Lane& lane : timeline.lanes(begun))
            for (const PassSpan& span : lane.spans)
                if (lane.name == "cpu: ahead") {
                    shortest = std::min(shortest, 1000 * (span.end - span.begin));
                    longest = std::max(longest, 1000 * (span.end - span.begin));
                }
        const CooperationStats stats = work.stats();
        EXPECT_EQ(stats.plan, "behind");
        EXPECT_GE(stats.aheadMs, shortest * (1 - 1e-9));
        EXPECT_LE(stats.aheadMs, longest * (1 + 1e-9));
        EXPECT_GT(stats.overlapMs, 0);
        EXPECT_LE(stats.overlapMs, stats.aheadMs * (1 + 1e-9));
    };
    run(100);
    EXPECT_GT(timeline.completeSince(), 0);
    run(3);
}

TEST(CooperationOfTheCpu, ATruncatedTraceIsReported) {
    const std::string path = (std::filesystem::temp_directory_path() / "rivulet_trace_test.json").string();
    Said said;
    Timeline timeline(10);
    const double begin = hostSeconds();
    for (int k = 0; k < 10; ++k) timeline.add("main", {"step", begin, begin + 0.001});
    ASSERT_TRUE(writeTrace(path, timeline, said.log()));
    EXPECT_TRUE(said.notices.empty());
    timeline.add("main", {"step", begin, begin + 0.001});
    ASSERT_TRUE(writeTrace(path, timeline, said.log()));
    ASSERT_EQ(said.notices.size(), 1U);
    EXPECT_NE(said.notices[0].find("only the last"), std::string::npos) << said.notices[0];
    std::filesystem::remove(path);
    EXPECT_FALSE(writeTrace("/nowhere/at/all.json", timeline, {}));
}

TEST(CooperationOfTheCpu, HasNoGpuToHelp) {
    const std::unique_ptr<Device> cpu = makeTestCpu();
    auto session = Session::create(dam(), *cpu, {});
    ASSERT_TRUE(session);
    Said said;
    EXPECT_EQ(Cooperation(**session, Plan::thesis, nullptr, said.log()).plan(), Plan::alone);
    ASSERT_EQ(said.notices.size(), 1U);
}

// Every plan on every available device, the fastest first.
TEST(CooperationOfTheCpu, AutoTriesAllAvailablePlans) {
    const DrawFrame draw = [](Session&, const std::function<void()>& uploaded, std::vector<PassTime>& passes) -> Status {
        uploaded();
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
        passes = {{.name = "sleep", .ms = 2, .calls = 1}};
        return ok();
    };
    const SceneFile scene = dam("pbf");
    const GlFacts none = noGl("none here");
    std::vector<double> shares;
    const Result<std::vector<PlanTried>> tried = tryPlans(
        {.scene = scene, .gl = none, .draw = draw, .progress = [&](double share, const std::string&) { shares.push_back(share); }});
    ASSERT_TRUE(tried);
    ASSERT_GE(tried->size(), 1U);
    size_t cpus = 0;
    for (size_t k = 0; k < tried->size(); ++k) {
        const PlanTried& t = (*tried)[k];
        EXPECT_NE(t.backend, "gl");
        cpus += t.backend == "cpu" ? 1 : 0;
        EXPECT_GE(t.frameMs.median, 2);
        EXPECT_FALSE(t.passes.empty()) << nameOf(t);
        EXPECT_NEAR(t.drawing.at("sleep"), 2, 1.0e-9) << nameOf(t) << ": per frame, though several frames were counted";
        EXPECT_NE(t.plan, Plan::thesis) << "pbf has no cells to find before a step";
        if (k > 0) EXPECT_GE(t.frameMs.median, (*tried)[k - 1].frameMs.median);
    }
    const bool gpu = tried->front().backend == "cl" && listClDevices().front().sentence.find("(GPU") != std::string::npos;
    EXPECT_TRUE(cpus >= 1 || gpu) << "alone, and behind unless it was much slower; only beside a faster GPU neither";
    EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
    EXPECT_LT(shares.back(), 1);
    EXPECT_NE(sentenceOf(*tried, "gl").find("it replaces --backend gl"), std::string::npos) << sentenceOf(*tried, "gl");
}

}  // namespace
}  // namespace rivulet::cooperation_test
