#include "demos/rivulet/sweep_run.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sched.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <deque>
#include <filesystem>
#include <map>

#include "demos/rivulet/cli.h"
#include "demos/rivulet/interrupt.h"
#include "demos/rivulet/sweep_process.h"
#include "engine/app/capture.h"
#include "engine/core/file.h"
#include "engine/core/message_line.h"

namespace rivulet {

namespace {

namespace fs = std::filesystem;

// What the commands of a task may use: loops of rivulet, llvmpipe and PoCL each read their own variable. A value of the
// user stays for the last two; --threads sets the first.
void setThreads(int threads) {
    const std::string text = std::to_string(threads);
    (void)::setenv("RIVULET_THREADS", text.c_str(), 1);
    for (const char* name : {"LP_NUM_THREADS", "POCL_MAX_PTHREAD_COUNT"}) (void)::setenv(name, text.c_str(), 0);
}

// GNU parallel that is killed leaves its jobs alone: this one then ends with it. False: parallel has ended.
bool endWithParallel() {
    const char* text = std::getenv("PARALLEL_PID");
    const pid_t parallel = text == nullptr ? 0 : static_cast<pid_t>(std::strtol(text, nullptr, 10));
    if (parallel <= 0) return true;
    (void)::prctl(PR_SET_PDEATHSIG, SIGKILL);
    return ::kill(parallel, 0) == 0 || errno != ESRCH;
}

// Runs the commands of a task into its folder. Error (failed): one failed.
Status runCommands(const Sweep& sweep, const SweepFolder& folder, size_t task, int lock) {
    const std::string part = folder.part(task), logName = part + "/log.txt";
    std::error_code error;
    fs::remove_all(part, error);
    if (error) return failed(fmt::format("{} cannot be removed: {}", part, error.message()));
    if (Status made = makeFolder(part); !made) return made;
    const Descriptor log = openDescriptor(logName, O_WRONLY | O_CREAT | O_APPEND);
    if (!log.valid()) return failed(fmt::format("{} cannot be written: {}", logName, reasonOf(errno)));
    for (const SweepCommand& command : sweep.commands) {
        const NewProcess process{.words = wordsOf(sweep, command, task, part), .folder = sweep.folder, .output = log.get(), .kept = lock};
        const Result<pid_t> child = startProcess(process);
        if (!child) return child.error();
        int waited = 0;
        while (::waitpid(*child, &waited, 0) < 0 && errno == EINTR) {
        }
        const int status = exitStatusOf(waited);
        if (status == 0) continue;
        const Result<std::string> text = readFile(logName);
        const std::string last = text ? lastLine(*text) : "";
        return failed(fmt::format("task {}: `{}` ended with exit status {}{}{}; the log is {}", task, process.words.front(), status,
                                  last.empty() ? "" : ": ", last, logName));
    }
    const auto numbers = numbersOf(part + "/stats.json");
    if (!numbers) return failed(fmt::format("task {}: {}", task, numbers.error().message));
    return ok();
}

}  // namespace

int runSweepTask(const Sweep& sweep, const SweepFolder& folder, size_t task, int threads) {
    Result<Descriptor> lock = Descriptor();
    if (!folder.hasEnded(task)) {
        lock = folder.lock(task, false);
        if (lock && !lock->valid()) {
            fmt::print("task {} is run by another process; waiting for its end\n", task);
            flushOutput();
            lock = folder.lock(task, true);
        }
        if (!lock) return report(lock.error());
    }
    if (folder.hasEnded(task)) {  // before, or while it was being locked; its runner may have been killed before it removed the lock
        folder.removeLock(task);
        fmt::print("task {} has ended before\n", task);
        return kDone;
    }
    setThreads(threads);
    if (!endWithParallel()) return kFailed;
    if (Status done = runCommands(sweep, folder, task, lock->get()); !done) return report(done.error());
    const std::string part = folder.part(task), name = folder.ended(task);
    std::error_code renamed;
    fs::rename(part, name, renamed);
    if (renamed) return report(failed(fmt::format("{} cannot be renamed to {}: {}", part, name, renamed.message())));
    folder.removeLock(task);
    if (Status collected = folder.collectSoon(sweep, task); !collected) return report(collected.error());
    return kDone;
}

int allowedProcessors() {
    cpu_set_t allowed;
    CPU_ZERO(&allowed);
    if (::sched_getaffinity(0, sizeof allowed, &allowed) == 0) return std::max(CPU_COUNT(&allowed), 1);
    return static_cast<int>(std::max(::sysconf(_SC_NPROCESSORS_ONLN), 1L));
}

namespace {

class SweepJobs {
  public:
    SweepJobs(const Sweep& sweep, const SweepFolder& folder, int jobs, int threads)
        : sweep_(sweep), folder_(folder), jobs_(static_cast<size_t>(jobs)), threads_(threads) {
        std::vector<bool> done(sweep.tasks);
        for (const size_t task : folder.endedTasks())
            if (task < sweep.tasks) done[task] = true;
        for (size_t task = 0; task < sweep.tasks; ++task)
            if (!done[task]) waiting_.push_back(task);
        before_ = ended_ = sweep.tasks - waiting_.size();
    }

    Status run(const Graceful& graceful) {
        sigset_t ofChildren;
        sigemptyset(&ofChildren);
        sigaddset(&ofChildren, SIGCHLD);
        (void)::sigprocmask(SIG_BLOCK, &ofChildren, nullptr);  // for sigtimedwait; startProcess unblocks it in the child
        Progress progress("sweep");
        bool stopped = false;
        size_t inTable = ended_;
        auto collected = std::chrono::steady_clock::now();
        while (!running_.empty() || ((!waiting_.empty() || !elsewhere_.empty()) && !graceful.interrupted())) {
            if (graceful.interrupted() && !stopped) {
                for (const auto& [child, task] : running_) ::kill(-child, SIGTERM);
                stopped = true;
            }
            while (!stopped && running_.size() < jobs_ && next())
                if (Status started = start(); !started) return started;
            progress.show(static_cast<double>(ended_) / static_cast<double>(sweep_.tasks),
                          fmt::format("{} of {} tasks{}", ended_, sweep_.tasks,
                                      failures_.empty() ? "" : fmt::format(", {} failed", failures_.size())));
            const timespec wait{0, 200'000'000};
            (void)::sigtimedwait(&ofChildren, nullptr, &wait);
            reap(graceful);
            constexpr std::chrono::seconds kBetweenTables(2);
            if (ended_ == inTable || std::chrono::steady_clock::now() - collected < kBetweenTables) continue;
            (void)folder_.collect(sweep_);  // an error is reported at the end
            inTable = ended_;
            collected = std::chrono::steady_clock::now();
        }
        return ok();
    }

    size_t ended() const { return ended_; }
    size_t before() const { return before_; }
    const std::map<size_t, std::string>& failures() const { return failures_; }

  private:
    // Whether a task can be started; it is then the first of waiting_. Tasks that another process runs come last, when it no longer does.
    bool next() {
        if (!waiting_.empty()) return true;
        for (size_t k = 0; k < elsewhere_.size(); ++k) {
            const size_t task = elsewhere_[k];
            if (folder_.isHeld(task)) continue;
            elsewhere_.erase(elsewhere_.begin() + static_cast<ptrdiff_t>(k));
            waiting_.push_back(task);
            return true;
        }
        return false;
    }

    Status start() {
        const size_t task = waiting_.front();
        waiting_.pop_front();
        if (folder_.isHeld(task)) {
            elsewhere_.push_back(task);
            return ok();
        }
        const int said = ::memfd_create("messages of a task", MFD_CLOEXEC);
        if (said < 0) return failed(fmt::format("no memory for the messages of a task: {}", reasonOf(errno)));
        std::vector<std::string> words = taskLine(sweep_, folder_, task, threads_);
        words.erase(words.begin());
        Descriptor messages(said);
        const Result<pid_t> child = startProcess({.words = words, .errors = messages.get(), .group = true});
        if (!child) return child.error();
        messages_.emplace(*child, std::move(messages));
        running_.emplace(*child, task);
        return ok();
    }

    void reap(const Graceful& graceful) {
        for (siginfo_t next{}; ::waitid(P_ALL, 0, &next, WEXITED | WNOHANG | WNOWAIT) == 0 && next.si_pid != 0; next = {}) {
            const pid_t child = next.si_pid;
            if (graceful.interrupted()) ::kill(-child, SIGKILL);  // what is left of the task, before its number is free for another group
            int waited = 0;
            (void)::waitpid(child, &waited, 0);
            const auto at = running_.find(child);
            if (at == running_.end()) continue;
            const size_t task = at->second;
            running_.erase(at);
            const Descriptor messages = std::move(messages_.at(child));
            messages_.erase(child);
            const int status = exitStatusOf(waited);
            if (folder_.hasEnded(task) && status == 0)
                ++ended_;
            else if (status == 0)
                elsewhere_.push_back(task);
            else if (!graceful.interrupted())
                failures_.emplace(task, messageOf(messages, task, status));
        }
    }

    static std::string messageOf(const Descriptor& messages, size_t task, int status) {
        std::string text(4096, '\0');
        const ssize_t got = ::pread(messages.get(), text.data(), text.size(), 0);
        text.resize(got > 0 ? static_cast<size_t>(got) : 0);
        std::string last = lastLine(text);
        if (last.starts_with("rivulet: ")) last.erase(0, 9);
        return last.empty() ? fmt::format("task {} ended with exit status {}", task, status) : last;
    }

    const Sweep& sweep_;
    const SweepFolder& folder_;
    size_t jobs_;
    int threads_;
    size_t before_ = 0, ended_ = 0;  // tasks that have ended: at the start, now
    std::deque<size_t> waiting_;
    std::vector<size_t> elsewhere_;  // tasks that another process runs
    std::map<pid_t, size_t> running_;
    std::map<pid_t, Descriptor> messages_;
    std::map<size_t, std::string> failures_;
};

}  // namespace

int runSweepTasks(const Sweep& sweep, const SweepFolder& folder, int jobs, int threads) {
    const Graceful graceful;
    SweepJobs all(sweep, folder, jobs, threads);
    if (const auto before = folder.collect(sweep); !before) return report(before.error());  // removes tasks without a folder from the table
    Descriptor table = folder.takeTable();
    if (Status run = all.run(graceful); !run) return report(run.error());
    (void)table.close();
    constexpr size_t kShown = 10;
    size_t shown = 0;
    for (const auto& [task, why] : all.failures())
        if (shown++ < kShown) (void)report(failed(why));
    const size_t failures = all.failures().size();
    if (failures > kShown)
        (void)report(failed(fmt::format("{} more tasks failed; each has a log in {}", failures - kShown, folder.file("tasks"))));
    const Result<TableSize> size = folder.collect(sweep);
    if (!size) return report(size.error());
    fmt::print("{}: {} of {} tasks have ended{}{}\n", printable(folder.file("results.csv")), all.ended(), sweep.tasks,
               all.before() > 0 ? fmt::format(", {} of them before", all.before()) : "",
               failures > 0 ? fmt::format(", {} failed", failures) : "");
    if (size->rows > 0 && size->numbers == 0)
        fmt::print("no task has left a stats.json in its folder, {{task}}: the table has the parameters only\n");
    if (graceful.status() != 0) return graceful.status();
    return failures > 0 ? kFailed : kDone;
}

}  // namespace rivulet
