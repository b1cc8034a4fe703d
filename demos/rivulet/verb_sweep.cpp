#include <fmt/format.h>

#include <filesystem>

#include "demos/rivulet/cli.h"
#include "demos/rivulet/sweep_engines.h"
#include "demos/rivulet/sweep_folder.h"
#include "demos/rivulet/sweep_run.h"
#include "engine/core/file.h"
#include "engine/core/message_line.h"

namespace rivulet {

namespace {

constexpr int kMostThreads = 1024;              // and jobs
constexpr size_t kLargest = size_t{64} << 20U;  // of SWEEP.json, bytes

std::string absolutePath(const std::string& path) {
    std::error_code error;
    const std::filesystem::path whole = std::filesystem::absolute(path, error);
    return error ? path : whole.lexically_normal().string();
}

}  // namespace

int sweepVerb(const Arguments& arguments) {
    ArgumentReader reader(
        "sweep",
        "Runs a command for each combination of parameter values. Tasks that have ended are not run again, so that the same "
        "command goes on after a stop. Results are in DIR/results.csv.");
    std::string file, output, engine;
    std::optional<int> task, jobs, threads;
    bool dryRun = false;
    reader.positional("SWEEP.json", "a sweep: commands, parameters and their values (docs/sweeps.md)", file, true);
    reader.option("--output", "DIR", "folder of the tasks and their results; default: NAME of NAME.json", output);
    reader.option("--task", "K", "run one task only, 0 for the first", task, 0, static_cast<int>(kMostTasks) - 1);
    reader.option("--jobs", "N", "number of tasks at a time; default: the processors divided by --threads", jobs, 1, kMostThreads);
    reader.option("--threads", "N", "number of threads of each task; default: 1", threads, 1, kMostThreads);
    reader.option("--with", "ENGINE", "run the tasks by slurm (submits an array job) or by parallel (GNU parallel)", engine);
    reader.flag("--dry-run", "check the sweep and write DIR/tasks.txt, one command a line, but run nothing; with slurm DIR/slurm.sh too",
                dryRun);
    if (std::optional<int> code = reader.read(arguments)) return *code;
    const std::vector<std::string> engines = {"slurm", "parallel"};
    if (!engine.empty())
        if (Status known = checkWord("engine", engine, engines); !known) return report(known.error());
    if (task && (dryRun || !engine.empty()))
        return report(badInput(fmt::format("--task cannot be used with {}; leave one of them out", dryRun ? "--dry-run" : "--with")));
    file = absolutePath(file);
    if (output.empty()) output = std::filesystem::path(file).stem().string();
    const SweepFolder folder(absolutePath(output));
    const int each = threads.value_or(1), many = jobs.value_or(std::max(allowedProcessors() / each, 1));
    const bool prepared = task && folder.isPrepared();  // tasks do not depend on SWEEP.json, which may change while they run
    const Result<std::string> text = prepared ? Result<std::string>(std::string()) : readFile(file, kLargest);
    if (!text) return report(text.error());
    const Result<Sweep> sweep = prepared ? folder.prepared() : readSweep(*text, file);
    if (!sweep) return report(sweep.error());
    if (task && static_cast<size_t>(*task) >= sweep->tasks)
        return report(
            badInput(fmt::format("--task {}: {} has {} tasks, the last is {}", *task, sweep->file, sweep->tasks, sweep->tasks - 1)));
    if (!prepared)
        if (Status made = folder.prepare(*sweep, *text, each); !made) return report(made.error());
    if (task) return runSweepTask(*sweep, folder, static_cast<size_t>(*task), each);
    if (engine == "slurm") return sweepWithSlurm(*sweep, folder, each, dryRun);
    if (dryRun) {
        fmt::print("{}: {} tasks\n", printable(folder.file("tasks.txt")), sweep->tasks);
        return kDone;
    }
    return engine == "parallel" ? sweepWithParallel(*sweep, folder, many, each) : runSweepTasks(*sweep, folder, many, each);
}

}  // namespace rivulet
