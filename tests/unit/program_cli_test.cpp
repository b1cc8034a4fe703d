// The program's arguments: help, mistakes and what they are answered with.
#include <gtest/gtest.h>

#include "tests/unit/program_runner.h"

namespace rivulet::testing::program_cli_test {
namespace {

TEST(ProgramCli, HelpListsTheArgumentsOfEveryVerb) {
    Outcome top = runProgram({"--help"});
    EXPECT_EQ(top.code, 0);
    for (const char* verb : {"run", "list", "info", "voxelize", "bench"}) {
        EXPECT_NE(top.out.find(std::string("\n  ") + verb), std::string::npos) << verb;
        Outcome help = runProgram({verb, "--help"});
        EXPECT_EQ(help.code, 0) << verb;
        EXPECT_NE(help.out.find("--help"), std::string::npos) << verb;
        EXPECT_EQ(help.err, "") << verb;
        EXPECT_TRUE(std::filesystem::exists(std::string(RIVULET_SOURCE_DIR "/demos/rivulet/verb_") + verb + ".cpp"))
            << "demos/run.sh knows verbs by it";
    }
    Outcome run = runProgram({"run", "--help"});
    for (const char* option :
         {"--backend", "--headless", "--no-render", "--frames", "--seconds", "--size", "--out", "--video", "--stats", "--set"})
        EXPECT_NE(run.out.find(option), std::string::npos) << option;
}

TEST(ProgramCli, NothingAskedIsBadUse) {
    Outcome outcome = runProgram({});
    EXPECT_EQ(outcome.code, 2);
    EXPECT_NE(outcome.err.find("Usage"), std::string::npos);
}

TEST(ProgramCli, AMistypedNameIsAnsweredWithTheNearest) {
    Scratch scratch;
    std::string scene = scratch.file("small.json", smallScene());
    expectRefusal(runProgram({"runn", scene}), 2, "did you mean 'run'");
    expectRefusal(runProgram({"falling_cub"}), 2, "`rivulet run falling_cube`");
    expectRefusal(runProgram({scene}), 2, "`rivulet run " + scene + "`");
    expectRefusal(runProgram({"run", scene, "--bakcend", "cpu"}), 2, "did you mean '--backend'");
    expectRefusal(runProgram({"run", "--headles", scene}), 2, "did you mean '--headless'");
    expectRefusal(runProgram({"run", scene, "--backend", "cpuu"}), 2, "did you mean 'cpu'");
    expectRefusal(runProgram({"list", "scene"}), 2, "did you mean 'scenes'");
    expectRefusal(runProgram({"run", scene, "--set", "fluid.spacin=0.1"}), 2, "spacing");
}

TEST(ProgramCli, InvalidArgumentsAreRefused) {
    Scratch scratch;
    std::string scene = scratch.file("small.json", smallScene());
    expectRefusal(runProgram({"run"}), 2, "SCENE");
    expectRefusal(runProgram({"run", scene, scene}), 2, "unexpected argument");
    for (const char* size : {"0x5", "axb", "1280", "1280x", "1280x720x3", "-5x5", "99999x1", "1e3x2", ""})
        expectRefusal(runProgram({"run", scene, "--headless", "--size", size}), 2, "--size");
    expectRefusal(runProgram({"run", scene, "--frames", "-1"}), 2, "--frames");
    expectRefusal(runProgram({"run", scene, "--frames", "many"}), 2, "--frames");
    expectRefusal(runProgram({"run", scene, "--seconds", "nan"}), 2, "--seconds");
    expectRefusal(runProgram({"run", scene, "--seconds", "1", "--frames", "2"}), 2, "--seconds");
    expectRefusal(runProgram({"run", scene, "--no-render", "--video", "x.mp4"}), 2, "--video");
    expectRefusal(runProgram({"bench", "no_such_case"}), 2, "no_such_case");
}

TEST(ProgramCli, ListAndInfoAnswer) {
    for (const char* what : {"scenes", "methods", "renderers", "filters", "voxels", "devices"}) {
        Outcome list = runProgram({"list", what});
        EXPECT_EQ(list.code, 0) << what << ": " << list.err;
        EXPECT_GT(linesIn(list.out), 0U) << what;
    }
    EXPECT_NE(runProgram({"list", "methods"}).out.find("wcsph"), std::string::npos);
    EXPECT_NE(runProgram({"list", "scenes"}).out.find("dam_break"), std::string::npos);
    EXPECT_NE(runProgram({"list", "--parameters"}).out.find("spacing"), std::string::npos);
    Outcome info = runProgram({"info"});
    EXPECT_EQ(info.code, 0) << info.err;
    for (const char* word : {"CPU", "OpenGL", "OpenCL", "auto"}) EXPECT_NE(info.out.find(word), std::string::npos) << word;
}

TEST(ProgramCli, OutputThatCannotBeWrittenIsAFailure) {
    RunOptions full;
    full.stdoutFile = "/dev/full";
    Outcome outcome = runProgram({"list", "--parameters"}, full);
    EXPECT_EQ(outcome.code, 1);
    EXPECT_TRUE(outcome.err.starts_with("rivulet: ")) << outcome.err;
    EXPECT_EQ(linesIn(outcome.err), 1U) << outcome.err;
}

}  // namespace
}  // namespace rivulet::testing::program_cli_test
