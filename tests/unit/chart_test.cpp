// The chart's table: its front, and reading back what was written.
#include <gtest/gtest.h>

#include <filesystem>

#include "engine/core/file.h"
#include "fluid/validate/chart.h"

namespace rivulet::chart_test {
namespace {

ChartRow row(const char* name, const char* setting, double error, double cost) {
    return {.name = name,
            .what = "a figure, of two",
            .setting = setting,
            .spacing = 0.02,
            .particles = 8000,
            .error = error,
            .wallPerSecond = cost,
            .sweepsPerSecond = 1200,
            .stepsPerSecond = 240,
            .compression = 0.004,
            .fastest = 1.5};
}

TEST(Chart, RowsThatNoRowBeatsInBothAreOnTheFront) {
    std::vector<ChartRow> rows = {row("dam_break", "pbf", 0.10, 1), row("dam_break", "dfsph", 0.02, 4), row("dam_break", "wcsph", 0.05, 5),
                                  row("dam_break", "pbf 6", 0.10, 2), row("hydrostatic", "wcsph", 0.5, 9)};
    markFront(rows);
    EXPECT_TRUE(rows[0].onFront) << "the cheapest";
    EXPECT_TRUE(rows[1].onFront) << "the most accurate";
    EXPECT_FALSE(rows[2].onFront) << "dearer and worse than dfsph";
    EXPECT_FALSE(rows[3].onFront) << "as accurate as pbf, and dearer";
    EXPECT_TRUE(rows[4].onFront) << "alone in its case";
}

TEST(Chart, IsReadAsItWasWritten) {
    Chart chart;
    chart.rows = {row("dam_break", "pbf 3, short steps", 0.1, 1.5), row("dam_break", "dfsph", 0.02, 4)};
    markFront(chart.rows);
    chart.viscosity = {{1, 2, 0.01, 0.02, 0.5}, {8, 2, 0.002, 0.01, 2}};
    chart.refused = {"taylor_green, wcsph_thesis: no"};
    const std::filesystem::path folder = std::filesystem::path(::testing::TempDir()) / "chart";
    std::filesystem::create_directories(folder);
    const Status written = writeChart(chart, folder.string(), "a machine", "a command");
    ASSERT_TRUE(written) << written.error().message;
    const std::vector<ChartRow> read = readChart(*readFile((folder / "speed_accuracy.csv").string()));
    ASSERT_EQ(read.size(), 2U);
    for (size_t k = 0; k < 2; ++k) {
        EXPECT_EQ(read[k].name, chart.rows[k].name);
        EXPECT_EQ(read[k].setting, chart.rows[k].setting);
        EXPECT_EQ(read[k].particles, 8000U);
        EXPECT_DOUBLE_EQ(read[k].error, chart.rows[k].error);
        EXPECT_DOUBLE_EQ(read[k].wallPerSecond, chart.rows[k].wallPerSecond);
        EXPECT_DOUBLE_EQ(read[k].compression, 0.004);
        EXPECT_DOUBLE_EQ(read[k].fastest, 1.5);
        EXPECT_EQ(read[k].onFront, chart.rows[k].onFront);
    }
    const std::string page = *readFile((folder / "speed_accuracy.md").string());
    for (const char* words : {"Best: **dfsph**", "Within 20 %: **pbf 3, short steps**", "taylor_green, wcsph_thesis: no", "a machine",
                              "least with 8 corrections and 2 steps"})
        EXPECT_NE(page.find(words), std::string::npos) << words << page;
    for (const char* file : {"speed_accuracy_dam_break.svg", "pbf_viscosity.svg", "pbf_viscosity.csv"})
        EXPECT_TRUE(std::filesystem::exists(folder / file)) << file;
    std::filesystem::remove_all(folder);
    EXPECT_TRUE(readChart("# nothing\ncase,what\n,,,\n").empty());
}

}  // namespace
}  // namespace rivulet::chart_test
