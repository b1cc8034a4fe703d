// The thesis's chapter 4: the page agrees with the table, and a short run measures the documented quantities.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "engine/app/context_egl.h"
#include "engine/core/file.h"
#include "engine/gpu/device_gl.h"
#include "fluid/validate/chapter4.h"
#include "tests/unit/program_runner.h"

namespace rivulet::chapter4_test {
namespace {

Chapter4Row row(int particles, const char* grid, const char* walk, double stepMs, double drawMs, int workGroup = 128, bool sizes = false) {
    const double ms = stepMs + drawMs;
    return {.particles = particles,
            .grid = grid,
            .walk = walk,
            .workGroup = workGroup,
            .sizes = sizes,
            .frames = spreadOf({900 / ms, 1000 / ms, 1200 / ms}),
            .runMs = {0.8 * ms, ms, 1.1 * ms},  // slow runs are slow for all
            .frameMs = ms,
            .stepMs = stepMs,
            .drawMs = drawMs,
            .passes = *walk != '\0' ? std::map<std::string, double>{{"fluid/solids/collide", 2},
                                                                    {"fluid/solids/walls", 1},
                                                                    {"fluid/methods/wcsph_density", 9}}
                                    : std::map<std::string, double>{{"fluid/methods/wcsph_density", 9}}};
}

TEST(Chapter4, ThePageComparesTheTableWithTheThesis) {
    Chapter4 chapter;
    chapter.drawnBy = "a tested GPU";
    chapter.width = 640;
    chapter.height = 480;
    chapter.mesh = "spot.obj";
    chapter.voxels = 128;
    for (const int particles : {2048, 16384}) {
        const double most = particles / 1024.0;
        chapter.rows.push_back(row(particles, "linked_list", "", 1.0 * most, 4));
        chapter.rows.push_back(row(particles, "linked_list", "thesis", 1.75 * most, 4));
        chapter.rows.push_back(row(particles, "linked_list", "exact", 1.25 * most, 4));
        chapter.rows.push_back(row(particles, "sorted", "", 0.5 * most, 4));
        chapter.rows.push_back(row(particles, "sorted", "exact", 0.75 * most, 4));
    }
    for (const auto& [size, ms] : {std::pair(32, 30.0), std::pair(64, 25.0), std::pair(256, 26.0)})
        chapter.rows.push_back(row(16384, "linked_list", "thesis", ms, 4, size, true));
    testing::Scratch scratch;
    const Status written = writeChapter4(chapter, scratch.path(), "a machine", "rivulet bench chapter4 --out docs");
    const std::filesystem::path folder(scratch.path());
    EXPECT_TRUE(written || written.error().message.find("gnuplot") != std::string::npos) << written.error().message;
    EXPECT_EQ(static_cast<bool>(written), std::filesystem::exists(folder / "chapter4.svg"));

    const Result<std::string> csv = readFile((folder / "chapter4.csv").string()), page = readFile((folder / "chapter4.md").string());
    ASSERT_TRUE(csv && page);
    EXPECT_EQ(std::count(csv->begin(), csv->end(), '\n'), 2 + 13);
    EXPECT_NE(csv->find("# a machine; 640x480 pixels by a tested GPU\n"), std::string::npos);
    EXPECT_NE(csv->find("16384,linked_list,thesis,128,31.25,28.12,37.5,32,28,4\n"), std::string::npos) << *csv;
    EXPECT_NE(csv->find("2048,sorted,none,128,200,180,240,5,1,4\n"), std::string::npos) << *csv;
    for (const char* said :
         {"above 15 frames a second | 31.2 with lists and the thesis's walk (28 ms per step, 4 ms of drawing); 62.5 with the "
          "sorted grid",
          // (32 - 20) / 32, and 3 of 12; of 2,048 particles the thesis said nothing.
          "above as many particles: 38 % of the frame, 25 % of the step", "| 16384 | 38 % (38 to 38) | 25.0 % |",
          "A step is shortest with 64 threads (the thesis used 128)", "onto spot.obj, hollow, voxelised at 128",
          "a machine, backend gl and pictures by a tested GPU", "| 2048 | 167 (150 to 200) | 133 (120 to 160) |"})
        EXPECT_NE(page->find(said), std::string::npos) << said << "\n" << *page;
    EXPECT_EQ(page->find("(chapter4.svg)") != std::string::npos, static_cast<bool>(written));
}

TEST(Chapter4, AShortRunMeasuresAllThatTakesTurns) {
    Result<ContextEgl> context = ContextEgl::create();
    if (!context) GTEST_SKIP() << context.error().message;
    const std::unique_ptr<Device> device = makeGlDevice(ShaderFiles::developer());
    Chapter4Request request;
    request.device = device.get();
    request.runs = 1;
    request.particles = {512};
    request.workGroups = {32, 64};
    size_t reported = 0;
    request.report = [&](const Chapter4Row&) { ++reported; };
    const Result<Chapter4> chapter = runChapter4(request);
    ASSERT_TRUE(chapter) << chapter.error().message;
    ASSERT_EQ(chapter->rows.size(), 7U);
    EXPECT_EQ(reported, 7U);
    for (const Chapter4Row& r : chapter->rows) {
        EXPECT_EQ(r.frames.count, 1U);
        EXPECT_NEAR(r.frames.median * r.frameMs, 1000, 1.0e-6);
        EXPECT_NEAR(r.stepMs + r.drawMs, r.frameMs, 1.0e-6);
        EXPECT_EQ(r.passes.contains("fluid/solids/collide"), !r.walk.empty()) << r.grid;
        EXPECT_EQ(r.passes.contains("fluid/grid/cell_link"), r.grid == "linked_list");
        EXPECT_EQ(r.passes.contains("fluid/grid/cell_sort"), r.grid == "sorted");
    }
    EXPECT_EQ(chapter->rows[5].workGroup, 32);
    EXPECT_TRUE(chapter->rows[5].sizes);

    // A stop between runs is reported.
    request.goOn = [] { return false; };
    const Result<Chapter4> none = runChapter4(request);
    ASSERT_TRUE(none) << none.error().message;
    EXPECT_TRUE(none->stopped);
    EXPECT_TRUE(none->rows.empty());
}

}  // namespace
}  // namespace rivulet::chapter4_test
