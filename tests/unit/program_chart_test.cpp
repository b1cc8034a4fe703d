// `rivulet chart` and scenes with a budget, as a person types them.
#include <gtest/gtest.h>

#include <csignal>

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
