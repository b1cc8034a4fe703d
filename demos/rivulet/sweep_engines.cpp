#include "demos/rivulet/sweep_engines.h"

#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>

#include "demos/rivulet/cli.h"
#include "demos/rivulet/sweep_process.h"
#include "engine/app/capture.h"
#include "engine/core/file.h"
#include "engine/core/message_line.h"
#include "engine/core/number.h"

namespace rivulet {

namespace {

constexpr int kNotFound = 127;  // the status of /usr/bin/env for a program that does not exist

// The exit status of a program. Error (failed): it is not installed.
Result<int> waitFor(const NewProcess& process, const std::string& name, const char* package) {
    const Result<pid_t> child = startProcess(process);
    if (!child) return child.error();
    int waited = 0;
    while (::waitpid(*child, &waited, 0) < 0 && errno == EINTR) {
    }
    if (exitStatusOf(waited) == kNotFound) return failed(fmt::format("{} is not installed (Debian package: {})", name, package));
    return exitStatusOf(waited);
}

struct EngineOutput {
    int status = 0;
    std::string text;  // stdout
};

// Runs a program that is searched in PATH. `package`: the Debian package that has it. Error (failed): it is not installed.
Result<EngineOutput> runEngine(std::vector<std::string> words, const char* package) {
    const std::string name = words.front();
    words.insert(words.begin(), "/usr/bin/env");
    const Descriptor output(::memfd_create("output of a program", MFD_CLOEXEC));
    if (!output.valid()) return failed(fmt::format("no memory for the output of {}: {}", name, reasonOf(errno)));
    const Result<int> status = waitFor({.words = words, .output = output.get(), .errors = STDERR_FILENO}, name, package);
    if (!status) return status.error();
    EngineOutput done{*status, {}};
    char bytes[4096];
    for (ssize_t got = 0; (got = ::pread(output.get(), bytes, sizeof bytes, static_cast<off_t>(done.text.size()))) > 0;)
        done.text.append(bytes, static_cast<size_t>(got));
    return done;
}

// The most indices of one array job. Error: Slurm does not answer.
Result<size_t> longestArray() {
    const Result<EngineOutput> config = runEngine({"scontrol", "show", "config"}, "slurm-client");
    if (!config) return config.error();
    const size_t at = config->text.find("MaxArraySize");
    constexpr std::string_view kDigits = "0123456789";
    const size_t digits = at == std::string::npos ? at : config->text.find_first_of(kDigits, at);
    size_t most = 0;
    if (config->status != 0 || digits == std::string::npos ||
        !parseNumber(config->text.substr(digits, config->text.find_first_not_of(kDigits, digits) - digits), most) || most < 1)
        return failed("`scontrol show config` names no MaxArraySize; check that Slurm's controller runs (sinfo)");
    return most;
}

// A file name in an option of a script: quoted, because it may have blanks, and without the symbols that Slurm replaces. Error (badInput):
// it has characters that Slurm cannot read.
Result<std::string> slurmName(const std::string& name) {
    if (name.find_first_of("\"\\\n\r") != std::string::npos)
        return badInput(fmt::format(
            "{} has a quotation mark, a backslash or a line break, which Slurm does not accept; choose another --output", printable(name)));
    std::string escaped;
    for (const char c : name) escaped += c == '%' ? std::string("%%") : std::string(1, c);
    return escaped;
}

// "0-4,7,9-11".
std::string rangesOf(const std::vector<size_t>& sorted) {
    std::string text;
    for (size_t k = 0; k < sorted.size();) {
        size_t last = k;
        while (last + 1 < sorted.size() && sorted[last + 1] == sorted[last] + 1) ++last;
        text += fmt::format("{}{}", text.empty() ? "" : ",", sorted[k]);
        if (last > k) text += fmt::format("-{}", sorted[last]);
        k = last + 1;
    }
    return text;
}

std::vector<size_t> openTasks(const Sweep& sweep, const SweepFolder& folder) {
    const std::vector<size_t> ended = folder.endedTasks();
    std::vector<size_t> open;
    open.reserve(sweep.tasks);
    for (size_t task = 0; task < sweep.tasks; ++task)
        if (!std::binary_search(ended.begin(), ended.end(), task)) open.push_back(task);
    return open;
}

}  // namespace

int sweepWithSlurm(const Sweep& sweep, const SweepFolder& folder, int threads, bool dryRun) {
    const std::vector<size_t> open = openTasks(sweep, folder);
    if (open.empty()) {
        fmt::print("all {} tasks have ended: {}\n", sweep.tasks, printable(folder.file("results.csv")));
        return kDone;
    }
    const Result<std::string> logs = slurmName(folder.file("slurm"));
    if (!logs) return report(logs.error());
    constexpr size_t kDefaultArray = 1001;  // Slurm's default MaxArraySize
    size_t most = kDefaultArray;
    if (!dryRun) {
        const Result<size_t> longest = longestArray();
        if (!longest) return report(longest.error());
        most = *longest;
    }
    // An index of the array is a task; if there are too many tasks, or too many gaps for the option, each index does every `stride`-th one.
    std::string array = rangesOf(open);
    size_t stride = sweep.tasks;
    constexpr size_t kLongestOption = 2000;
    if (open.back() >= most || array.size() > kLongestOption) {
        stride = std::min(sweep.tasks, most);
        array = fmt::format("0-{}", stride - 1);
    }
    if (Status made = makeFolder(folder.file("slurm")); !made) return report(made.error());
    std::vector<std::string> words = taskLine(sweep, folder, 0, threads);
    const auto number = std::find(words.begin(), words.end(), "--task") + 1;
    *number = "TASK";
    std::string line = shellLine(words);
    constexpr std::string_view kNumber = " --task TASK";
    line.replace(line.rfind(kNumber), kNumber.size(), " --task \"$task\"");
    const std::string script = fmt::format(
        "#!/bin/bash\n"
        "# An array job: sbatch {0}/slurm.sh. Options of sbatch that are not here come from the environment: SBATCH_PARTITION, ...\n"
        "#SBATCH --job-name=rivulet-sweep\n"
        "#SBATCH --array={1}\n"
        "#SBATCH --ntasks=1\n"
        "#SBATCH --cpus-per-task={2}\n"
        "#SBATCH --output=\"{6}/%a.txt\"\n"
        "status=0\n"
        "for ((task = SLURM_ARRAY_TASK_ID; task < {3}; task += {4})); do\n"
        "    {5} || status=1\n"
        "done\n"
        "exit $status\n",
        folder.path(), array, threads, sweep.tasks, stride, line, *logs);
    const std::string name = folder.file("slurm.sh");
    if (Status written = writeFileAtomic(name, script, 0777); !written) return report(written.error());
    if (dryRun) {
        fmt::print("{}\n", printable(name));
        return kDone;
    }
    const Result<EngineOutput> submitted = runEngine({"sbatch", "--parsable", name}, "slurm-client");
    if (!submitted) return report(submitted.error());
    if (submitted->status != 0) return report(failed(fmt::format("sbatch {} ended with exit status {}", name, submitted->status)));
    fmt::print("job {}: {} tasks; squeue shows them, and {} has their results\n", lastLine(submitted->text), open.size(),
               printable(folder.file("results.csv")));
    return kDone;
}

int sweepWithParallel(const Sweep& sweep, const SweepFolder& folder, int jobs, int threads) {
    std::string lines;
    for (const size_t task : openTasks(sweep, folder)) lines += shellLine(taskLine(sweep, folder, task, threads)) + '\n';
    const Descriptor input(::memfd_create("tasks", MFD_CLOEXEC));
    for (size_t done = 0; done < lines.size();) {
        const ssize_t wrote = input.valid() ? ::write(input.get(), lines.data() + done, lines.size() - done) : -1;
        if (wrote < 0) return report(failed(fmt::format("no memory for the list of tasks: {}", reasonOf(errno))));
        done += static_cast<size_t>(wrote);
    }
    (void)::lseek(input.get(), 0, SEEK_SET);
    flushOutput();
    const Result<int> status = waitFor({.words = {"/usr/bin/env", "parallel", "--will-cite", "--jobs", std::to_string(jobs)},
                                        .input = input.get(),
                                        .output = STDOUT_FILENO,
                                        .errors = STDERR_FILENO},
                                       "parallel", "parallel");
    if (!status) return report(status.error());
    if (const auto collected = folder.collect(sweep); !collected) return report(collected.error());
    const size_t open = openTasks(sweep, folder).size();
    fmt::print("{}: {} of {} tasks have ended\n", printable(folder.file("results.csv")), sweep.tasks - open, sweep.tasks);
    return open > 0 ? kFailed : kDone;
}

}  // namespace rivulet
