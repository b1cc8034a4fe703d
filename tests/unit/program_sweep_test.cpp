// `rivulet sweep`: tasks end once, whatever is killed, and the table does not depend on how they were run.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <thread>

#include "tests/unit/sweep_files.h"

namespace rivulet::testing::program_sweep_test {
namespace {

namespace fs = std::filesystem;

// The table without its times, which come last.
std::string withoutTimes(const Scratch& scratch, const std::string& file) {
    const auto rows = rowsAt(scratch, file);
    if (rows.empty()) return "";
    const auto time = std::find_if(rows[0].begin(), rows[0].end(), [](const std::string& name) { return name.starts_with("time."); });
    const auto columns = static_cast<size_t>(time - rows[0].begin());
    std::string text;
    for (const auto& row : rows) {
        for (size_t c = 0; c < std::min(columns, row.size()); ++c) text += row[c] + ' ';
        text += '\n';
    }
    return text;
}

TEST(ProgramSweep, TheTableHasTheFiguresOfEachRun) {
    const Scratch scratch;
    scratch.file("small.json", smallScene());
    scratch.file("s.json", kSmallSweep);
    const Outcome swept = runProgram({"sweep", "s.json"}, in(scratch));
    ASSERT_EQ(swept.code, 0) << swept.err;
    EXPECT_NE(swept.out.find("8 of 8 tasks have ended"), std::string::npos) << swept.out;
    const auto rows = rowsAt(scratch, "s/results.csv");
    ASSERT_EQ(rows.size(), 9U);
    EXPECT_EQ(rows[0][1], "fluid.viscosity");
    EXPECT_EQ(rows[0][2], "fluid.method");
    const auto column = [&](const char* name) {
        return static_cast<size_t>(std::find(rows[0].begin(), rows[0].end(), name) - rows[0].begin());
    };
    ASSERT_LT(column("energy.kinetic"), rows[0].size());
    EXPECT_LT(column("time.wallSeconds"), rows[0].size());
    for (const size_t task : {0U, 3U, 7U}) {
        const auto& row = rows[task + 1];
        EXPECT_EQ(row[0], std::to_string(task));
        EXPECT_NEAR(std::stod(row[1]), std::pow(10.0, -6.0 + static_cast<double>(task / 2)), 1e-11);
        EXPECT_EQ(row[2], task % 2 == 0 ? "pbf" : "wcsph");
        ASSERT_EQ(runProgram({"run", "small.json", "--no-render", "--backend", "cpu", "--frames", "2", "--stats", "alone.json", "--set",
                              "fluid.viscosity=" + row[1], "--set", "fluid.method=" + row[2]},
                             in(scratch))
                      .code,
                  0);
        EXPECT_NE(scratch.text("alone.json").find("\"kinetic\": " + row[column("energy.kinetic")]), std::string::npos) << task;
    }
    EXPECT_NE(scratch.text("s/tasks/0/stats.json").find(", 1 thread, "), std::string::npos) << "each task has one thread";
}

// Whatever order tasks end in, and whichever process runs them.
TEST(ProgramSweep, TheTableDoesNotDependOnTheOrder) {
    const Scratch scratch;
    scratch.file("small.json", smallScene());
    scratch.file("s.json", kSmallSweep);
    ASSERT_EQ(runProgram({"sweep", "s.json", "--jobs", "3"}, in(scratch)).code, 0);
    ASSERT_EQ(runProgram({"sweep", "s.json", "--output", "one", "--dry-run"}, in(scratch)).code, 0);
    EXPECT_FALSE(fs::exists(scratch.path() / "one/results.csv")) << "a dry run runs nothing";
    EXPECT_EQ(linesIn(scratch.text("one/tasks.txt")), 8U);
    for (const char* task : {"5", "7", "0", "2", "6", "1", "3", "4"})
        ASSERT_EQ(runProgram({"sweep", "s.json", "--output", "one", "--task", task}, in(scratch)).code, 0);
    EXPECT_EQ(withoutTimes(scratch, "one/results.csv"), withoutTimes(scratch, "s/results.csv"));
    EXPECT_EQ(linesIn(scratch.text("one/results.csv")), 9U);

    // A table that was lost, or that lacks a row, is made again from the tasks, byte for byte.
    const std::string table = scratch.text("one/results.csv");
    const size_t row = table.find("\n4,");
    std::string ofASpreadsheet = table;  // with the line ends of RFC 4180
    for (size_t at = 0; (at = ofASpreadsheet.find('\n', at)) != std::string::npos; at += 2) ofASpreadsheet.insert(at, 1, '\r');
    for (const std::string& damaged : {std::string(), table.substr(0, row + 1), table.substr(0, row + 9), ofASpreadsheet}) {
        scratch.file("one/results.csv", damaged.empty() ? " " : damaged);
        ASSERT_EQ(runProgram({"sweep", "s.json", "--output", "one"}, in(scratch)).code, 0);
        EXPECT_EQ(scratch.text("one/results.csv"), table);
    }
    // Slurm's script, run as an array job does: one process for each index.
    ASSERT_EQ(runProgram({"sweep", "s.json", "--output", "array", "--with", "slurm", "--dry-run"}, in(scratch)).code, 0);
    EXPECT_NE(scratch.text("array/slurm.sh").find("#SBATCH --array=0-7\n"), std::string::npos);
    for (int k = 7; k >= 0; --k) {
        RunOptions index = in(scratch);
        index.environment = {{"SLURM_ARRAY_TASK_ID", std::to_string(k)}};
        ASSERT_EQ(runCommand({"bash", "array/slurm.sh"}, index).code, 0);
    }
    EXPECT_EQ(withoutTimes(scratch, "array/results.csv"), withoutTimes(scratch, "s/results.csv"));
}

TEST(ProgramSweep, AnArrayThatIsTooLongForSlurmSharesItsTasks) {
    const Scratch scratch;
    scratch.file("s.json", R"({"command": "/bin/true {k}", "parameters": {"k": {"from": 0, "to": 2402, "count": 2403}}})");
    ASSERT_EQ(runProgram({"sweep", "s.json", "--with", "slurm", "--dry-run"}, in(scratch)).code, 0);
    EXPECT_NE(scratch.text("s/slurm.sh").find("#SBATCH --array=0-1000\n"), std::string::npos);
    RunOptions index = in(scratch);
    index.environment = {{"SLURM_ARRAY_TASK_ID", "401"}};
    ASSERT_EQ(runCommand({"bash", "s/slurm.sh"}, index).code, 0);
    const auto rows = rowsAt(scratch, "s/results.csv");
    ASSERT_EQ(rows.size(), 3U) << "tasks 401 and 1402; 2403 does not exist";
    EXPECT_EQ(rows[1], (std::vector<std::string>{"401", "401"}));
    EXPECT_EQ(rows[2], (std::vector<std::string>{"1402", "1402"}));
}

// Slurm splits its options at blanks and replaces symbols that begin with %.
TEST(ProgramSweep, SlurmsScriptQuotesItsFolder) {
    const Scratch scratch;
    scratch.file("s.json", R"({"command": "/bin/true {k}", "parameters": {"k": [1, 2]}})");
    ASSERT_EQ(runProgram({"sweep", "s.json", "--output", "a TASK 9%", "--with", "slurm", "--dry-run"}, in(scratch)).code, 0);
    const std::string script = scratch.text("a TASK 9%/slurm.sh");
    EXPECT_NE(script.find("#SBATCH --output=\"" + scratch.path().string() + "/a TASK 9%%/slurm/%a.txt\"\n"), std::string::npos) << script;
    RunOptions index = in(scratch);
    index.environment = {{"SLURM_ARRAY_TASK_ID", "1"}};
    ASSERT_EQ(runCommand({"bash", "a TASK 9%/slurm.sh"}, index).code, 0);
    EXPECT_TRUE(fs::exists(scratch.path() / "a TASK 9%/tasks/1"));
    expectRefusal(runProgram({"sweep", "s.json", "--output", "a\"b", "--with", "slurm", "--dry-run"}, in(scratch)), 2,
                  "choose another --output");
}

// Each task leaves the number of its process: one that is run again has another.
const std::string kSlowSweep =
    R"x({"command": "/bin/sh -c 'echo {k} $$ >{task}/process; for k in 1 2 3 4 5 6 7 8; do echo >>{task}/beats; sleep 0.05; done'",
    "parameters": {"k": {"from": 0, "to": 9, "count": 10}}})x";

std::map<std::string, std::string> processesOf(const Scratch& scratch) {
    std::map<std::string, std::string> processes;
    for (const auto& entry : fs::directory_iterator(scratch.path() / "s/tasks"))
        if (entry.path().extension().empty())
            processes[entry.path().filename()] = scratch.text("s/tasks/" + entry.path().filename().string() + "/process");
    return processes;
}

uintmax_t beatsOf(const Scratch& scratch) {
    uintmax_t beats = 0;
    std::error_code missing;
    for (const auto& entry : fs::directory_iterator(scratch.path() / "s/tasks", missing)) {
        std::error_code none;
        const uintmax_t bytes = fs::file_size(entry.path() / "beats", none);
        if (!none) beats += bytes;
    }
    return beats;
}

TEST(ProgramSweep, AKilledSweepLosesNoTaskAndRunsNoneTwice) {
    for (const int signal : {SIGKILL, SIGINT}) {
        const Scratch scratch;
        scratch.file("s.json", kSlowSweep);
        RunOptions killed = in(scratch);
        bool sent = false;  // a second SIGINT would end it at once, without a table
        killed.whileRunning = [&](pid_t) {
            std::error_code none;
            if (sent || !fs::exists(scratch.path() / "s/tasks/2", none)) return 0;
            sent = true;
            return signal;
        };
        const Outcome stopped = runProgram({"sweep", "s.json", "--jobs", "2"}, killed);
        EXPECT_EQ(stopped.code, 128 + signal) << stopped.err;
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
        const uintmax_t beats = beatsOf(scratch);
        std::this_thread::sleep_for(std::chrono::milliseconds(300));
        EXPECT_EQ(beatsOf(scratch), beats) << "no task outlives the sweep";
        const auto before = processesOf(scratch);
        EXPECT_GE(before.size(), 1U);
        EXPECT_LT(before.size(), 10U);
        if (signal == SIGINT) EXPECT_EQ(rowsAt(scratch, "s/results.csv").size(), before.size() + 1) << "what ended is in the table";

        const Outcome resumed = runProgram({"sweep", "s.json", "--jobs", "4"}, in(scratch));
        ASSERT_EQ(resumed.code, 0) << resumed.err;
        const auto after = processesOf(scratch);
        EXPECT_EQ(after.size(), 10U);
        for (const auto& [task, process] : before) EXPECT_EQ(after.at(task), process) << task;
        EXPECT_EQ(rowsAt(scratch, "s/results.csv").size(), 11U);
        for (const auto& entry : fs::directory_iterator(scratch.path() / "s/tasks"))
            EXPECT_TRUE(entry.path().extension().empty()) << entry.path() << " is left";
    }
}

TEST(ProgramSweep, TwoProcessesDoATaskOnce) {
    const Scratch scratch;
    scratch.file("s.json", kSlowSweep);
    Outcome second;
    RunOptions first = in(scratch);
    first.whileRunning = [&](pid_t) {
        std::error_code none;
        if (second.code < 0 && fs::exists(scratch.path() / "s/tasks/3.part/beats", none))
            second = runProgram({"sweep", "s.json", "--task", "3"}, in(scratch));
        return 0;
    };
    EXPECT_EQ(runProgram({"sweep", "s.json", "--task", "3"}, first).code, 0);
    EXPECT_EQ(second.code, 0) << second.err;
    EXPECT_EQ(second.out, "task 3 is run by another process; waiting for its end\ntask 3 has ended before\n");
    EXPECT_EQ(scratch.text("s/tasks/3/beats").size(), 8U);
    EXPECT_EQ(runProgram({"sweep", "s.json", "--task", "3"}, in(scratch)).out, "task 3 has ended before\n");
    // Two sweeps of the same folder share the tasks.
    Outcome other;
    RunOptions both = in(scratch);
    both.whileRunning = [&](pid_t) {
        if (other.code < 0) other = runProgram({"sweep", "s.json", "--jobs", "2"}, in(scratch));
        return 0;
    };
    const Outcome one = runProgram({"sweep", "s.json", "--jobs", "2"}, both);
    for (const Outcome& outcome : {one, other}) {
        EXPECT_EQ(outcome.code, 0) << outcome.err;
        EXPECT_NE(outcome.out.find("10 of 10 tasks have ended"), std::string::npos) << outcome.out;
    }
    EXPECT_EQ(beatsOf(scratch), 80U);
}

TEST(ProgramSweep, AFailedTaskIsReportedAndTriedAgain) {
    const Scratch scratch;
    scratch.file("s.json", R"x({"command": "/bin/sh -c 'test {k} != 2 || test -f go || {{ echo no go >&2; exit 3; }'",
                               "parameters": {"k": [1, 2, 3]}})x");
    const Outcome failed = runProgram({"sweep", "s.json"}, in(scratch));
    EXPECT_EQ(failed.code, 1);
    EXPECT_EQ(linesIn(failed.err), 1U) << failed.err;
    EXPECT_NE(failed.err.find("task 1: `/bin/sh` ended with exit status 3: no go; the log is "), std::string::npos) << failed.err;
    EXPECT_NE(failed.out.find("2 of 3 tasks have ended, 1 failed"), std::string::npos) << failed.out;
    EXPECT_EQ(rowsAt(scratch, "s/results.csv").size(), 3U);
    EXPECT_EQ(scratch.text("s/tasks/1.part/log.txt"), "no go\n");
    scratch.file("go", "go");
    EXPECT_EQ(runProgram({"sweep", "s.json"}, in(scratch)).code, 0);
    EXPECT_EQ(rowsAt(scratch, "s/results.csv").size(), 4U);
    scratch.file("missing.json", R"({"command": "/usr/bin/env nowhere.program"})");
    expectRefusal(runProgram({"sweep", "missing.json", "--task", "0"}, in(scratch)), 1, "ended with exit status 127");
}

// A script that starts a program: the signal reaches both, and an interrupted task has not failed. The signal is sent to the group, as a
// terminal does.
TEST(ProgramSweep, CtrlCEndsAllThatATaskStarted) {
    const Scratch scratch;
    scratch.file("beat.sh", "while true; do echo >>\"$1/beats\"; sleep 0.02; done\n");
    scratch.file("s.json", R"x({"command": "/bin/bash -c '/bin/bash beat.sh {task} & wait' {k}", "parameters": {"k": [1, 2]}})x");
    RunOptions options = in(scratch);
    options.before = [] { (void)::setpgid(0, 0); };
    bool sent = false;
    options.whileRunning = [&](pid_t sweep) {
        if (sent || beatsOf(scratch) < 4) return 0;
        sent = true;
        ::kill(-sweep, SIGINT);
        return 0;
    };
    const Outcome stopped = runProgram({"sweep", "s.json", "--jobs", "2"}, options);
    EXPECT_EQ(stopped.code, 128 + SIGINT);
    EXPECT_EQ(stopped.err, "");
    EXPECT_NE(stopped.out.find("0 of 2 tasks have ended\n"), std::string::npos) << stopped.out;
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    const uintmax_t beats = beatsOf(scratch);
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    EXPECT_EQ(beatsOf(scratch), beats);
}

// A process that outlives its killed task holds the task's lock: the task waits for it and is then run, so that status 0 means that it
// ended.
TEST(ProgramSweep, ATaskThatIsHeldElsewhereIsDoneBeforeItReportsSuccess) {
    const Scratch scratch;
    scratch.file("s.json", R"({"command": "/bin/true {k}", "parameters": {"k": [1, 2]}})");
    ASSERT_EQ(runProgram({"sweep", "s.json", "--dry-run"}, in(scratch)).code, 0);
    Outcome task;
    RunOptions options = in(scratch);
    options.whileRunning = [&](pid_t) {
        if (task.code < 0 && fs::exists(scratch.path() / "held")) task = runProgram({"sweep", "s.json", "--task", "1"}, in(scratch));
        return 0;
    };
    ASSERT_EQ(runCommand({"/usr/bin/flock", "s/tasks/1.lock", "/bin/sh", "-c", "touch held; sleep 0.5"}, options).code, 0);
    EXPECT_EQ(task.code, 0) << task.err;
    EXPECT_TRUE(fs::exists(scratch.path() / "s/tasks/1"));
}

// The runner was killed between the end of its task and the removal of the lock.
TEST(ProgramSweep, TheLockOfATaskThatHasEndedIsRemoved) {
    const Scratch scratch;
    scratch.file("s.json", R"({"command": "/bin/true {k}", "parameters": {"k": [1]}})");
    ASSERT_EQ(runProgram({"sweep", "s.json", "--dry-run"}, in(scratch)).code, 0);
    for (const std::vector<std::string>& words : {std::vector<std::string>{"sweep", "s.json", "--task", "0"}, {"sweep", "s.json"}}) {
        fs::remove_all(scratch.path() / "s/tasks/0");
        fs::remove(scratch.path() / "held");
        Outcome waiting;
        RunOptions options = in(scratch);
        options.whileRunning = [&](pid_t) {
            if (waiting.code < 0 && fs::exists(scratch.path() / "held")) waiting = runProgram(words, in(scratch));
            return 0;
        };
        ASSERT_EQ(runCommand({"/usr/bin/flock", "s/tasks/0.lock", "/bin/sh", "-c", "touch held; sleep 0.5; mkdir s/tasks/0"}, options).code,
                  0);
        EXPECT_EQ(waiting.code, 0) << waiting.err;
        EXPECT_FALSE(fs::exists(scratch.path() / "s/tasks/0.lock")) << words.size();
    }
}

// Two sweeps that start at once: the second waits while the first prepares the folder.
TEST(ProgramSweep, DifferentSweepsNeverShareAFolder) {
    const Scratch scratch;
    scratch.file("s.json", R"({"command": "/bin/true {k}", "parameters": {"k": [1, 2]}})");
    scratch.file("t.json", R"({"command": "/bin/true {k}", "parameters": {"k": [3, 4]}})");
    ASSERT_EQ(runProgram({"sweep", "s.json", "--dry-run"}, in(scratch)).code, 0);
    fs::create_directory(scratch.path() / "both");
    Outcome second;
    RunOptions first = in(scratch);
    first.whileRunning = [&](pid_t) {
        if (second.code < 0 && fs::exists(scratch.path() / "held"))
            second = runProgram({"sweep", "t.json", "--output", "both"}, in(scratch));
        return 0;
    };
    const char* prepare = "touch held; sleep 0.3; cp s/sweep.json s/origin.json s/tasks.txt both";
    ASSERT_EQ(runCommand({"/usr/bin/flock", "both/sweep.lock", "/bin/sh", "-c", prepare}, first).code, 0);
    expectRefusal(second, 2, "t.json has changed since its tasks in ");
    EXPECT_FALSE(fs::exists(scratch.path() / "both/results.csv"));
    EXPECT_EQ(scratch.text("both/sweep.json"), scratch.text("s.json"));
}

// Processes that began before the sweep grew write the rows of the new tasks, too.
TEST(ProgramSweep, ATableHasTheTasksThatASweepGrewBy) {
    for (const std::vector<std::string>& words : {std::vector<std::string>{"sweep", "s.json", "--task", "0"}, {"sweep", "s.json"}}) {
        const Scratch scratch;
        const auto sweep = [&](const char* values) {
            scratch.file(
                "s.json",
                fmt::format(R"x({{"command": "/bin/sh -c 'test {{k}} != 0 || while ! test -f go; do sleep 0.02; done'", "parameters": )x"
                            R"x({{"k": {}}}}})x",
                            values));
            return runProgram({"sweep", "s.json", "--dry-run"}, in(scratch)).code;
        };
        ASSERT_EQ(sweep("[0]"), 0);
        bool grown = false;
        RunOptions options = in(scratch);
        options.whileRunning = [&](pid_t) {
            if (grown || !fs::exists(scratch.path() / "s/tasks/0.part")) return 0;
            grown = true;
            EXPECT_EQ(sweep("[0, 1, 2]"), 0);
            for (const char* task : {"1", "2"}) EXPECT_EQ(runProgram({"sweep", "s.json", "--task", task}, in(scratch)).code, 0);
            scratch.file("go", "go");
            return 0;
        };
        EXPECT_EQ(runProgram(words, options).code, 0);
        const auto rows = rowsAt(scratch, "s/results.csv");
        ASSERT_EQ(rows.size(), 4U) << words.size();
        EXPECT_EQ(rows[3], (std::vector<std::string>{"2", "2"}));
    }
}

// The table is read and written once for all tasks that end while it is busy, and lacks none at the end.
TEST(ProgramSweep, TasksThatEndTogetherAreAllInTheTable) {
    const Scratch scratch;
    scratch.file("s.json", R"({"command": "/bin/true {k}", "parameters": {"k": {"from": 1, "to": 40, "count": 40}}})");
    ASSERT_EQ(runProgram({"sweep", "s.json", "--dry-run"}, in(scratch)).code, 0);
    ASSERT_EQ(runCommand({"/bin/sh", "-c", "while read -r line; do sh -c \"$line\" & done <s/tasks.txt; wait"}, in(scratch)).code, 0);
    EXPECT_EQ(rowsAt(scratch, "s/results.csv").size(), 41U);
    // Another process has the table: tasks leave it to that one.
    const std::string before = scratch.text("s/results.csv");
    for (const char* task : {"7", "8"}) fs::remove_all(scratch.path() / "s/tasks" / task);
    ASSERT_EQ(runCommand({"/usr/bin/flock", "s/results.next", RIVULET_PROGRAM, "sweep", "s.json", "--task", "7"}, in(scratch)).code, 0);
    EXPECT_EQ(scratch.text("s/results.csv"), before) << "it was not written without task 8";
    ASSERT_EQ(runProgram({"sweep", "s.json"}, in(scratch)).code, 0);
    EXPECT_EQ(scratch.text("s/results.csv"), before);
}

// A table that cannot be written does not hide which tasks failed.
TEST(ProgramSweep, AFailedTaskIsReportedWithoutTheTable) {
    const Scratch scratch;
    scratch.file("s.json",
                 R"({"command": "/bin/sh -c 'rm s/results.csv; mkdir -p s/results.csv/in_the_way; exit {k}'", "parameters": {"k": [1]}})");
    const Outcome swept = runProgram({"sweep", "s.json"}, in(scratch));
    EXPECT_EQ(swept.code, 1);
    EXPECT_NE(swept.err.find("task 0: `/bin/sh` ended with exit status 1"), std::string::npos) << swept.err;
    EXPECT_NE(swept.err.find("results.csv"), std::string::npos) << swept.err;
}

// McKay, Beckman and Conover 1979: each of n equal parts of each range is used once. The same seed gives the same tasks everywhere.
TEST(ProgramSweep, AHypercubeUsesEachPartOfEachRangeOnce) {
    const Scratch scratch;
    const auto sweep = [](int seed) {
        return fmt::format(R"({{"command": "/bin/true {{a}} {{b}} {{c}}", "sampling": "latin hypercube", "samples": 12, "seed": {},
                           "parameters": {{"a": {{"from": -3, "to": 9}}, "b": {{"from": 1e-6, "to": 1, "scale": "log"}},
                                           "c": ["x", "y", "z"]}}}})",
                           seed);
    };
    scratch.file("s.json", sweep(7));
    scratch.file("t.json", sweep(8));
    for (const char* file : {"s.json", "t.json"}) ASSERT_EQ(runProgram({"sweep", file}, in(scratch)).code, 0);
    const auto rows = rowsAt(scratch, "s/results.csv");
    ASSERT_EQ(rows.size(), 13U);
    std::set<int> partsOfA, partsOfB;
    std::map<std::string, int> of;
    for (size_t k = 1; k < rows.size(); ++k) {
        partsOfA.insert(static_cast<int>(std::floor(std::stod(rows[k][1]) + 3)));
        partsOfB.insert(static_cast<int>(std::floor((std::log10(std::stod(rows[k][2])) + 6) * 2)));
        ++of[rows[k][3]];
    }
    EXPECT_EQ(partsOfA.size(), 12U);
    EXPECT_EQ(*partsOfA.begin(), 0);
    EXPECT_EQ(partsOfB.size(), 12U);
    EXPECT_EQ(of, (std::map<std::string, int>{{"x", 4}, {"y", 4}, {"z", 4}}));
    EXPECT_NE(scratch.text("s/results.csv"), scratch.text("t/results.csv"));
    EXPECT_EQ(rows[1], (std::vector<std::string>{"0", "5.95987408", "0.600808387", "y"}));
}

TEST(ProgramSweep, ErrorsNamePlaceAndRemedyAndLeaveNothing) {
    const Scratch scratch;
    scratch.file("small.json", smallScene());
    const auto refused = [&](const std::string& rest, const std::string& mentions) {
        scratch.file("s.json", rest);
        expectRefusal(runProgram({"sweep", "s.json"}, in(scratch)), 2, mentions);
        EXPECT_EQ(scratch.contents(), (std::vector<std::string>{"s.json", "small.json"})) << rest;
    };
    const auto values = [](const std::string& range) {
        return R"({"command": "run small.json --no-render", "parameters": {"fluid.viscosity": )" + range + "}}";
    };
    refused(values(R"({"from": 0, "to": 1, "count": 3, "scale": "log"})"), "s.json:1:86: a logarithmic range must be above 0");
    refused(values(R"({"from": 1, "to": 1, "count": 3})"), "the range of fluid.viscosity is empty");
    refused(values(R"({"from": 1, "to": 2})"), "add \"count\": 5");
    refused(values(R"({"from": 1, "to": 2, "cuont": 3})"), "did you mean `count`?");
    refused(values("[]"), "has no values");
    refused(values("[[1]]"), "must be a number, a text or true or false");
    refused(values("[1, 1e9]"), "s.json:1:77: task 1: --set fluid.viscosity=1e9: fluid.viscosity is 1e9 m^2/s, must be between 0 and 10");
    refused(values(R"([1], "fluid.spacin": [0.1])"), "did you mean fluid.spacing?");
    refused(values(R"({"from": 1, "to": 2, "count": 1000}, "fluid.spacing": {"from": 1, "to": 2, "count": 1000})"), "more than 100000");
    refused(R"({"command": "run small.json", "samples": 4})", "s.json:1:42: `samples` belongs to a hypercube");
    refused(R"({"command": "run small.json", "sampling": "latin hypercube"})", "add for example \"samples\": 100");
    refused(R"({"command": "run smal.json --no-render"})", "task 0: smal.json does not exist");
    refused(R"({"command": "run small.json --no-rendr"})", "did you mean '--no-render'?");
    refused(R"({"command": "run small.json --out {tsk}"})", "did you mean {task}?");
    refused(R"({"command": "list", "parameters": {"a": [1]}})", "no command uses a");
    refused(R"({"command": "run 'small.json"})", "has one ' without its partner");
    refused(R"({"parameters": {}})", "`command` is missing");
    refused(R"({"command": "run small.json --frames {f}", "parameters": {"f": {"from": 0, "to": 3, "pieces": 4}}})",
            "cannot be cut into 4 pieces");
    refused(R"({"command": "rnu small.json"})", "s.json:1:13: 'rnu' is no verb of rivulet; a program that is searched in PATH");
    refused(R"({"command": "python3 x.py {n}", "parameters": {"n": [1]}})", "is written /usr/bin/env python3");
    refused(R"({"command": "/no/such/prog"})", "the program /no/such/prog does not exist");
    refused(R"({"command": "./small.json"})", "./small.json is not executable");
    refused(R"({"command": "run small.json --out o", "parameters": {"fluid.viscosity": [1, 2]}})", "tasks 0 and 1 both write --out o;");
    refused(R"({"command": "run small.json --stats=a{n}", "parameters": {"n": [1, 2, 1]}})", "tasks 0 and 2 both write --stats a1");
    refused(R"({"command": "voxelize a.obj --resolution {n}", "parameters": {"n": [8, 16]}})",
            "s.json:1:13: without --out, tasks of voxelize may write the same file; add for example --out {task}/");
    refused(R"({"command": "join pieces{n}", "parameters": {"n": [1, 2]}})", "add for example --video {task}/");
    refused(R"({"command": "chart {c} --quick", "parameters": {"c": ["stability", "surface"]}})", "add for example --out {task}");
    refused(R"({"command": "chart {c} --sweep c.json", "parameters": {"c": ["taylor_green", "all"]}})", "both write --sweep c.json");
    refused(R"({"command": "voxelize a.obj --out {task}/a.rvox --slices s.png --resolution {n}", "parameters": {"n": [8, 16]}})",
            "tasks 0 and 1 both write --slices s.png");
    refused("{", "s.json:1:");
    expectRefusal(runProgram({"sweep", "none.json"}, in(scratch)), 2, "none.json cannot be read");
    scratch.file("s.json", R"({"command": "/bin/true"})");
    expectRefusal(runProgram({"sweep", "s.json", "--with", "slrum"}, in(scratch)), 2, "did you mean 'slurm'?");
    expectRefusal(runProgram({"sweep", "s.json", "--task", "1"}, in(scratch)), 2, "the last is 0");
    expectRefusal(runProgram({"sweep", "s.json", "--output", "."}, in(scratch)), 2, "is no folder of a sweep");
    RunOptions threads = in(scratch);
    threads.environment = {{"RIVULET_THREADS", "many"}};
    expectRefusal(runProgram({"list"}, threads), 2, "RIVULET_THREADS must be a number of threads");
}

TEST(ProgramSweep, AChangedSweepIsRefusedUnlessItGrew) {
    const Scratch scratch;
    const auto sweep = [&](const std::string& values) {
        scratch.file("s.json", R"({"command": "/bin/sh -c 'echo {k} $$ >{task}/process'", "parameters": {"k": )" + values + "}}");
        return runProgram({"sweep", "s.json"}, in(scratch));
    };
    ASSERT_EQ(sweep("[1, 2]").code, 0);
    const std::string process = scratch.text("s/tasks/1/process");
    expectRefusal(sweep("[1, 3]"), 2, "has changed since its tasks");
    expectRefusal(sweep("[1]"), 2, "has changed since its tasks");
    const Outcome grown = sweep("[1, 2, 3]");
    ASSERT_EQ(grown.code, 0) << grown.err;
    EXPECT_NE(grown.out.find("3 of 3 tasks have ended, 2 of them before"), std::string::npos) << grown.out;
    EXPECT_EQ(scratch.text("s/tasks/1/process"), process);
    EXPECT_EQ(linesIn(scratch.text("s/tasks.txt")), 3U);
}

}  // namespace
}  // namespace rivulet::testing::program_sweep_test
