// `rivulet chart` and scenes with a budget, as a person types them.
#include <gtest/gtest.h>

#include <csignal>
#include <sstream>

#include "engine/core/file.h"
#include "tests/unit/program_runner.h"

namespace rivulet::testing::program_chart_test {
namespace {

TEST(ProgramChart, InvalidArgumentsAreRefusedWithAMessage) {
    expectRefusal(runProgram({"chart", "hydrostatics"}), 2, "did you mean 'hydrostatic'");
    expectRefusal(runProgram({"chart", "stabilty"}), 2, "did you mean 'stability'");
    expectRefusal(runProgram({"chart", "--out", "/proc/nowhere"}), 1, "/proc/nowhere");
}

// Ctrl-C leaves nothing half-written behind.
TEST(ProgramChart, StopsWhenItIsAskedTo) {
    Scratch scratch;
    RunOptions in;
    in.folder = scratch.path();
    int looks = 0;
    in.whileRunning = [&looks](pid_t) { return ++looks == 100 ? SIGINT : 0; };
    const Outcome outcome = runProgram({"chart", "taylor_green", "--quick"}, in);
    EXPECT_EQ(outcome.code, 130) << outcome.err;
    EXPECT_EQ(scratch.contents(), std::vector<std::string>{"docs"});
}

// A point of the chart is the same in any process, but for its time; a chart is made of all its points only.
TEST(ProgramChart, PointsAreTasksOfASweep) {
    Scratch scratch;
    RunOptions in;
    in.folder = scratch.path();
    const Outcome listed = runProgram({"chart", "taylor_green", "--quick", "--sweep", "t.json"}, in);
    ASSERT_EQ(listed.code, 0) << listed.err;
    const Outcome swept = runProgram({"sweep", "t.json", "--task", "0"}, in);
    ASSERT_EQ(swept.code, 0) << swept.err;
    ASSERT_EQ(runProgram({"chart", "taylor_green", "--quick", "--point", "0", "--json", "alone.json"}, in).code, 0);
    const auto withoutTime = [](const std::string& file) {
        const Result<std::string> text = readFile(file);
        std::string kept;
        std::istringstream lines(text ? *text : "");
        for (std::string line; std::getline(lines, line);)
            if (line.find("wallPerSecond") == std::string::npos) kept += line + '\n';
        return kept;
    };
    EXPECT_EQ(withoutTime(scratch.file("t/tasks/0/stats.json")), withoutTime(scratch.file("alone.json")));
    EXPECT_NE(withoutTime(scratch.file("alone.json")).find("\"error\": "), std::string::npos);
    const Result<std::string> table = readFile(scratch.file("t/results.csv"));
    ASSERT_TRUE(table);
    EXPECT_NE(table->find(",error,"), std::string::npos) << *table;
    EXPECT_NE(table->find(",time.wallPerSecond"), std::string::npos) << *table;
    expectRefusal(runProgram({"chart", "taylor_green", "--quick", "--points", "t", "--out", "o"}, in), 2, "point 1 of 18 is missing");
    expectRefusal(runProgram({"chart", "taylor_green", "--quick", "--point", "18", "--json", "x"}, in), 2, "the last is 17");
    expectRefusal(runProgram({"chart", "stability", "--point", "1", "--json", "x"}, in), 2, "is of speed_accuracy.md alone");
    expectRefusal(runProgram({"chart", "--point", "1"}, in), 2, "add --json FILE.json");
}

TEST(ProgramBudget, ChoosesSettingsAndReportsThem) {
    Scratch scratch;
    RunOptions in;
    in.folder = scratch.path();
    scratch.file("s.json", R"({"name": "drop", "fluid": {"spacing": 0.02, "blocks": [{"min": [0.2, 0.2, 0.2], "max": [0.5, 0.5, 0.5]}]},
                              "budget": {"frameMs": 5000, "maxDensityError": 0.05}})");
    const Outcome outcome = runProgram({"run", "s.json", "--no-render", "--frames", "3", "--explain", "--stats", "o.json"}, in);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_NE(outcome.err.find("rivulet: budget of 5000 ms and 5 %: "), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.out.find("  budget of 5000 ms per frame and 5 % of density: "), std::string::npos) << outcome.out;
    EXPECT_NE(outcome.out.find("measured over 0.05 s"), std::string::npos) << outcome.out;
    expectRefusal(runProgram({"run", "s.json", "--no-render", "--set", "budget.frameMs=-1"}, in), 2, "budget.frameMs");
    expectRefusal(runProgram({"run", "s.json", "--no-render", "--set", "budget.frames=1"}, in), 2, "budget");
    expectRefusal(runProgram({"run", "s.json", "--no-render", "--save", "s.rstate"}, in), 2, "budget.frameMs=0");
}

}  // namespace
}  // namespace rivulet::testing::program_chart_test
