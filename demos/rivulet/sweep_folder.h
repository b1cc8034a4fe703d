// The folder of a sweep, which several processes use at a time:
//
//     sweep.json      the sweep, as it was given; tasks read it; sweep.lock: locked while it and the next two are written
//     origin.json     the folder of the commands, and what the tasks depend on (sweep_origin.h)
//     tasks.txt       one command line a task
//     tasks/7         a task that has ended: what its commands wrote, and log.txt, what they printed
//     tasks/7.part    one that runs, failed or was killed; tasks/7.lock: locked (flock) while it runs
//     results.csv     the parameters and the numbers of stats.json of each task that has ended; results.lock: locked while it is written,
//                     results.next: by the process that writes it next
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "demos/rivulet/sweep.h"
#include "engine/core/descriptor.h"

namespace rivulet {

struct SweepOrigin;

struct TableSize {
    size_t rows = 0;     // without the header
    size_t numbers = 0;  // columns that come from stats.json
};

class SweepFolder {
  public:
    explicit SweepFolder(std::string path) : path_(std::move(path)) {}  // absolute

    const std::string& path() const { return path_; }
    std::string file(const std::string& name) const { return path_ + "/" + name; }
    std::string ended(size_t task) const { return file("tasks/" + std::to_string(task)); }
    std::string part(size_t task) const { return ended(task) + ".part"; }

    // Writes sweep.json, origin.json and tasks.txt, unless they are there with the same content. `text`: the content of sweep.file;
    // `threads`: of each task. Error (badInput): the folder is that of another sweep, unless `sweep` has the same tasks and then more; as
    // checkOrigin and checkTasks. (failed): not writable. Of sweeps that start at once, one prepares the folder and the others find it so.
    Status prepare(const Sweep& sweep, std::string_view text, int threads) const;

    bool isPrepared() const;
    // The sweep that was prepared. Error: as readSweep and checkOrigin.
    Result<Sweep> prepared() const;

    bool hasEnded(size_t task) const;
    std::vector<size_t> endedTasks() const;  // in order
    // Locks a task, as lockFile.
    Result<Descriptor> lock(size_t task, bool wait) const;
    // Whether another process runs a task; leaves no lock.
    bool isHeld(size_t task) const;
    // Removes the lock of a task that has ended, which is no longer needed.
    void removeLock(size_t task) const;

    // Adds the tasks that have ended to results.csv and removes those without a folder; `again` is read again. The bytes depend on
    // nothing but the tasks; `next` is closed before the tasks are listed. Where a task has ended that `sweep` lacks, because the sweep has
    // grown, it is read again. Returns the size of the table. Error (failed): not writable.
    Result<TableSize> collect(const Sweep& sweep, std::optional<size_t> again = std::nullopt, Descriptor* next = nullptr) const;
    // The same for a task that has just ended, unless another process is about to do it: the table is read and written once for all tasks
    // that end meanwhile. When the last process has ended, it is complete.
    Status collectSoon(const Sweep& sweep, size_t task) const;
    // The tasks that end leave the table to this process, which collects after it has released the lock. Not valid: another process has it.
    Descriptor takeTable() const;

  private:
    Status adopt(const Sweep& sweep, std::string_view text, int threads) const;
    Status write(const Sweep& sweep, std::string_view text, int threads, const SweepOrigin& origin) const;
    Status writeTasks(const Sweep& sweep, int threads) const;
    std::string path_;
};

// Locks a file (flock), which is made if it does not exist; `wait`: until another process, and what it started, has released it. Not valid:
// another process has locked it. Error (failed): it cannot be locked.
Result<Descriptor> lockFile(const std::string& name, bool wait);

// The words of the command that runs one task, and a command as a shell reads it.
std::vector<std::string> taskLine(const Sweep& sweep, const SweepFolder& folder, size_t task, int threads);
std::string shellLine(const std::vector<std::string>& words);

// The numbers of a stats.json by their columns: "density.avgCompression"; the elements of a list have numbers as names. Times of the wall
// clock begin with "time.": the parts of their names include `passes`, or one that ends with Ms or begins with wall. Error (badInput):
// damaged.
Result<std::vector<std::pair<std::string, std::string>>> numbersOf(const std::string& statsFile);

}  // namespace rivulet
