// `rivulet sweep`: how each task finds its parameters, files and folder.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <tuple>

#include "tests/unit/sweep_files.h"

namespace rivulet::testing::program_sweep_tasks_test {
namespace {

namespace fs = std::filesystem;

TEST(ProgramSweep, TheListOfTasksFollowsTheOptions) {
    const Scratch scratch;
    scratch.file("s.json", R"({"command": "/bin/true {k}", "parameters": {"k": [1, 2]}})");
    ASSERT_EQ(runProgram({"sweep", "s.json", "--dry-run"}, in(scratch)).code, 0);
    EXPECT_EQ(scratch.text("s/tasks.txt").find("--threads"), std::string::npos);
    ASSERT_EQ(runProgram({"sweep", "s.json", "--threads", "3", "--dry-run"}, in(scratch)).code, 0);
    EXPECT_NE(scratch.text("s/tasks.txt").find("--task 1 --threads 3\n"), std::string::npos);
    fs::rename(scratch.path() / "s.json", scratch.path() / "t.json");
    ASSERT_EQ(runProgram({"sweep", "t.json", "--output", "s", "--dry-run"}, in(scratch)).code, 0);
    EXPECT_NE(scratch.text("s/tasks.txt").find("/t.json --output"), std::string::npos);
}

// The energy of a falling block is m (g t)^2 / 2: a parameter reaches each run that does not set it itself, whatever else it names.
TEST(ProgramSweep, AParameterThatIsNamedInBracesReachesItsRuns) {
    for (const std::string& commands :
         {std::string(R"("run small.json --no-render --backend cpu --frames 3", "/bin/echo {fluid.gravity}")"),
          std::string(R"("run small.json --no-render --backend cpu --frames 3 --trace {task}/{fluid.gravity}.json")")}) {
        const Scratch scratch;
        scratch.file("small.json", smallScene());
        scratch.file("s.json", R"({"commands": [)" + commands + R"(], "parameters": {"fluid.gravity": ["0,-9,0", "0,-1,0"], "n": [7]}})");
        expectRefusal(runProgram({"sweep", "s.json"}, in(scratch)), 2, "--set n=7: n is not a parameter");
        scratch.file("s.json", R"({"commands": ["/bin/echo {n}", )" + commands +
                                   R"(], "parameters": {"fluid.gravity": ["0,-9,0", "0,-1,0"], "n": [7]}})");
        const Outcome swept = runProgram({"sweep", "s.json"}, in(scratch));
        ASSERT_EQ(swept.code, 0) << swept.err;
        const std::string kinetic = "\"kinetic\": ";
        std::vector<double> energies;
        for (const char* task : {"0", "1"}) {
            const std::string stats = scratch.text(std::string("s/tasks/") + task + "/stats.json");
            const size_t at = stats.find(kinetic);
            ASSERT_NE(at, std::string::npos) << stats;
            energies.push_back(std::stod(stats.substr(at + kinetic.size())));
        }
        EXPECT_NEAR(energies[0] / energies[1], 81, 1) << commands;
    }
    // A run that sets the parameter itself: another value would not be a vector.
    const Scratch scratch;
    scratch.file("small.json", smallScene());
    scratch.file("s.json", R"({"command": "run small.json --no-render --frames 1 --set fluid.gravity=0,-{fluid.gravity},0",
                               "parameters": {"fluid.gravity": [1, 2]}})");
    const Outcome swept = runProgram({"sweep", "s.json"}, in(scratch));
    EXPECT_EQ(swept.code, 0) << swept.err;
}

TEST(ProgramSweep, AnExportWritesIntoTheFolderOfItsTask) {
    const Scratch scratch;
    scratch.file("small.json", smallScene());
    scratch.file("s.json", R"({"command": "export small.json --format zarr --seconds 0.05 --backend cpu --set fluid.viscosity={v}",
                               "parameters": {"v": [0.1, 1]}})");
    const Outcome swept = runProgram({"sweep", "s.json"}, in(scratch));
    ASSERT_EQ(swept.code, 0) << swept.err;
    EXPECT_FALSE(fs::exists(scratch.path() / "out"));
    EXPECT_NE(scratch.text("s/tasks/0/small.zarr/.zattrs").find("\"fluid.viscosity\": 0.1"), std::string::npos);
    EXPECT_NE(scratch.text("s/tasks/1/small.zarr/.zattrs").find("\"fluid.viscosity\": 1"), std::string::npos);
}

TEST(ProgramSweep, ARunWritesIntoTheFolderOfItsTask) {
    const Scratch scratch;
    scratch.file("small.json", smallScene());
    scratch.file("s.json",
                 R"({"command": "run small.json --frames 2 --no-render --backend cpu", "parameters": {"fluid.viscosity": [0.1, 1]}})");
    const Outcome swept = runProgram({"sweep", "s.json"}, in(scratch));
    ASSERT_EQ(swept.code, 0) << swept.err;
    EXPECT_EQ(swept.out.find("no task"), std::string::npos) << swept.out;
    EXPECT_FALSE(fs::exists(scratch.path() / "out"));
    const auto rows = rowsAt(scratch, "s/results.csv");
    ASSERT_EQ(rows.size(), 3U);
    EXPECT_NE(std::find(rows[0].begin(), rows[0].end(), "energy.kinetic"), rows[0].end());
    // Programs without numbers: a notice, because the table has none.
    scratch.file("t.json", R"({"command": "/bin/true {k}", "parameters": {"k": [1, 2]}})");
    const Outcome without = runProgram({"sweep", "t.json"}, in(scratch));
    EXPECT_NE(without.out.find("no task has left a stats.json"), std::string::npos) << without.out;
}

// Results of two scenes, or of two versions, are never in one table.
TEST(ProgramSweep, AFolderIsThatOfItsScenes) {
    const Scratch scratch;
    fs::create_directory(scratch.path() / "a");
    scratch.file("a/small.json", smallScene());
    scratch.file("a/s.json", kSmallSweep);
    const auto swept = [&](const char* folder, bool dry = true) {
        std::vector<std::string> words = {"sweep", std::string(folder) + "/s.json", "--output", "s"};
        if (dry) words.emplace_back("--dry-run");
        return runProgram(words, in(scratch));
    };
    ASSERT_EQ(swept("a").code, 0);
    // The same sweep beside another scene of the same name, and a scene that was edited.
    const std::string edited = smallScene() + "\n";
    fs::copy(scratch.path() / "a", scratch.path() / "b");
    scratch.file("b/small.json", edited);
    expectRefusal(swept("b"), 2, "b/small.json is not the file that the tasks in ");
    scratch.file("a/small.json", edited);
    expectRefusal(swept("a"), 2, "a/small.json is not the file that the tasks in ");
    expectRefusal(runProgram({"sweep", "a/s.json", "--output", "s", "--task", "0"}, in(scratch)), 2, "is not the file that");
    fs::remove(scratch.path() / "a/small.json");
    expectRefusal(swept("a"), 2, "small.json cannot be read: it does not exist; restore it");
    // A folder that was moved with its scenes.
    scratch.file("a/small.json", smallScene());
    fs::rename(scratch.path() / "a", scratch.path() / "c");
    const Outcome moved = swept("c", false);
    ASSERT_EQ(moved.code, 0) << moved.err;
    EXPECT_EQ(rowsAt(scratch, "s/results.csv").size(), 9U);
    // Another version.
    std::string origin = scratch.text("s/origin.json");
    const size_t at = origin.find(RIVULET_VERSION);
    ASSERT_NE(at, std::string::npos);
    scratch.file("s/origin.json", origin.replace(at, std::string(RIVULET_VERSION).size(), "0.0.9"));
    expectRefusal(swept("c"), 2, "were made by version 0.0.9 of rivulet");
}

// A recording or a state that tasks read, as the scenes: old and new results are never mixed.
TEST(ProgramSweep, AFolderIsThatOfItsRecordingsAndStates) {
    const Scratch scratch;
    scratch.file("small.json", smallScene());
    const auto made = [&](const char* option, const char* file, const char* frames) {
        return runProgram({"run", "small.json", "--no-render", "--backend", "cpu", "--frames", frames, option, file}, in(scratch)).code;
    };
    const auto sweep = [&](const std::string& file, const std::string& commands) {
        scratch.file(file, R"({"commands": [)" + commands + R"(], "parameters": {"n": [1, 2]}})");
        return runProgram({"sweep", file, "--dry-run"}, in(scratch));
    };
    for (const auto& [option, name, reads] :
         {std::tuple("--record", "r.rrec", R"("run small.json --replay r.rrec --frames 0:{n} --images")"),
          std::tuple("--save", "r.rstate", R"("run small.json --resume r.rstate --frames {n}")")}) {
        const std::string file = std::string(option + 2) + ".json";
        expectRefusal(sweep(file, reads), 2, std::string(file) + ":1:15: " + name + " cannot be read: it does not exist");
        ASSERT_EQ(made(option, name, "2"), 0);
        const std::string before = scratch.text(name);
        ASSERT_EQ(sweep(file, reads).code, 0);
        ASSERT_EQ(made(option, name, "3"), 0);
        expectRefusal(sweep(file, reads), 2, std::string(name) + " is not the file that the tasks in ");
        expectRefusal(runProgram({"sweep", file, "--task", "1"}, in(scratch)), 2, "is not the file that");
        scratch.file(name, before);
        EXPECT_EQ(sweep(file, reads).code, 0);
    }
    // Not those that the tasks themselves write.
    for (const char* commands :
         {R"("run small.json --record {task}/r.rrec", "run small.json --replay {task}/r.rrec --frames 0:{n} --images")",
          R"("run small.json --record r{n}.rrec", "run small.json --replay r{n}.rrec --images")",
          R"("/bin/cp r.rrec q{n}.rrec", "run small.json --replay q{n}.rrec --images")"}) {
        fs::remove_all(scratch.path() / "own");
        const Outcome own = sweep("own.json", commands);
        EXPECT_EQ(own.code, 0) << own.err;
    }
}

// Slurm may start a task hours after its sweep was submitted.
TEST(ProgramSweep, TasksDoNotDependOnTheFileThatTheyWereMadeFrom) {
    const Scratch scratch;
    scratch.file("s.json", R"({"command": "/bin/cp beside.txt {task}/{k}.txt", "parameters": {"k": [1, 2, 3]}})");
    scratch.file("beside.txt", "beside");
    ASSERT_EQ(runProgram({"sweep", "s.json", "--output", "out/s", "--dry-run"}, in(scratch)).code, 0);
    scratch.file("s.json", "{ edited");
    for (const char* task : {"0", "2"}) {
        const Outcome ran = runProgram({"sweep", "s.json", "--output", "out/s", "--task", task}, in(scratch));
        EXPECT_EQ(ran.code, 0) << ran.err;
        fs::remove(scratch.path() / "s.json");
    }
    EXPECT_EQ(scratch.text("out/s/tasks/2/3.txt"), "beside");
    expectRefusal(runProgram({"sweep", "s.json", "--output", "out/s", "--task", "3"}, in(scratch)), 2, "the last is 2");
}

}  // namespace
}  // namespace rivulet::testing::program_sweep_tasks_test
