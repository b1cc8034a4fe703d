// The thesis's chapter 2: the page agrees with the table, and a short run measures the documented quantities.
#include "fluid/validate/chapter2.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "engine/app/context_egl.h"
#include "engine/core/file.h"
#include "tests/unit/program_runner.h"

namespace rivulet::chapter2_test {
namespace {

Chapter2Row row(int particles, const char* backend, Plan plan, double stepMs, double drawMs, double overlapMs = 0) {
    const double ms = stepMs + drawMs;
    Chapter2Row r;
    r.particles = particles;
    r.way.backend = backend;
    r.way.plan = plan;
    r.way.frameMs = spreadOf({0.9 * ms, ms, 1.2 * ms});
    r.way.stepMs = stepMs;
    r.way.drawMs = drawMs;
    r.way.overlapMs = overlapMs;
    r.way.passes = {{"fluid/grid/cell_count", 1},       {"fluid/grid/scan_apply", 1},       {"fluid/grid/reorder", 2},
                    {"fluid/methods/wcsph_density", 4}, {"fluid/methods/wcsph_forces", 10}, {"fluid/solids/walls", 2}};
    return r;
}

TEST(Chapter2, ThePageComparesTheTableWithTheThesis) {
    Chapter2 chapter;
    chapter.drawnBy = "a tested GPU";
    chapter.width = 640;
    chapter.height = 480;
    chapter.devices = {"cpu: one", "gl: another"};
    chapter.picked = {{16384, "gl, thesis", 0.031}, {65536, "gl, thesis", 0}, {131072, "gl", 0.2}};
    for (const int particles : {16384, 65536, 131072}) {
        const double most = particles / 16384.0;
        chapter.rows.push_back(row(particles, "cpu", Plan::alone, 10 * most, 4));
        chapter.rows.push_back(row(particles, "gl", Plan::alone, 6 * most, 4));
        chapter.rows.push_back(row(particles, "gl", Plan::thesis, 5 * most, 4, 1.5));
    }
    testing::Scratch scratch;
    const Status written = writeChapter2(chapter, scratch.path(), "a machine", "rivulet bench chapter2 --out docs");
    EXPECT_TRUE(written || written.error().message.find("gnuplot") != std::string::npos) << written.error().message;
    const std::filesystem::path folder(scratch.path());
    const Result<std::string> csv = readFile((folder / "chapter2.csv").string()), page = readFile((folder / "chapter2.md").string());
    ASSERT_TRUE(csv && page);
    EXPECT_EQ(std::count(csv->begin(), csv->end(), '\n'), 2 + 9);
    EXPECT_NE(csv->find("16384,\"gl, thesis\",9,8.1,10.8,5,4,1.5\n"), std::string::npos) << *csv;
    for (const char* said :
         {"36.08 ms of simulation and 9.01 ms of drawing | gl: 24 ms of simulation and 4 ms of drawing; the fastest frame 24 ms (gl, "
          "thesis)",
          "above 10 frames a second | 131072 particles: 22.7 frames a second (gl, thesis)", "| 16384 | gl, thesis | 3.1 % |",
          "The aim is 5 %: 2 of 3 meet it.", "| 16384 | 14 (12.6 to 16.8) | 10 (9 to 12) | 9 (8.1 to 10.8) |",
          "| 65536 | gl | 5 | 15 | 20 | 50 | 10 | 20 | 4 |"})
        EXPECT_NE(page->find(said), std::string::npos) << said << "\n" << *page;
    EXPECT_EQ(page->find("(chapter2.svg)") != std::string::npos, static_cast<bool>(written));
}

// Runs that are slow for both give no comparison: 10 % tolerance of the median.
TEST(Chapter2, PlansAreComparedRunByRun) {
    const PlanTried other{.backend = "cpu", .turns = {10, 20, 40, 10, 10}}, own{.backend = "gl", .turns = {11, 22, 44, 9, 15}};
    EXPECT_NEAR(beyond(own, other), 0.1, 1.0e-12);
    EXPECT_EQ(beyond(other, other), 0);
}

TEST(Chapter2, AShortRunMeasuresEveryPlanThatThereIs) {
    Result<ContextEgl> context = ContextEgl::create();
    if (!context) GTEST_SKIP() << context.error().message;
    Chapter2Request request;
    request.gl = currentGlFacts();
    request.runs = 1;
    request.particles = 256;
    request.times = {1, 2};
    std::set<std::string> ways;
    request.report = [&](const Chapter2Row& r) { ways.insert(nameOf(r.way)); };
    const Result<Chapter2> chapter = runChapter2(request);
    ASSERT_TRUE(chapter) << chapter.error().message;
    for (const char* way : {"cpu", "cpu, behind", "gl", "gl, thesis"}) EXPECT_TRUE(ways.contains(way)) << way;
    EXPECT_EQ(chapter->rows.size(), 2 * ways.size());
    ASSERT_EQ(chapter->picked.size(), 2U);
    for (const Chapter2::Picked& p : chapter->picked) {
        EXPECT_TRUE(ways.contains(p.name)) << p.name;
        EXPECT_GT(p.behind, -0.5);
    }
    for (const Chapter2Row& r : chapter->rows) {
        EXPECT_TRUE(r.particles == 256 || r.particles == 512) << r.particles;
        EXPECT_NEAR(r.way.stepMs + r.way.drawMs, r.way.frameMs.median, 1.0e-6);
        EXPECT_EQ(r.way.passes.contains("fluid/methods/wcsph_forces"), true);
        if (r.way.plan == Plan::alone) EXPECT_EQ(r.way.overlapMs, 0);
    }
    request.goOn = [] { return false; };
    const Result<Chapter2> none = runChapter2(request);
    ASSERT_TRUE(none) << none.error().message;
    EXPECT_TRUE(none->stopped);
    EXPECT_TRUE(none->rows.empty());
}

}  // namespace
}  // namespace rivulet::chapter2_test
