#include "demos/rivulet/sweep_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <set>

#include "demos/rivulet/sweep_origin.h"
#include "engine/app/capture.h"
#include "engine/core/file.h"
#include "engine/core/folder.h"
#include "engine/core/number.h"

namespace rivulet {

namespace {

namespace fs = std::filesystem;

// A word as a shell reads it back.
std::string shellWord(const std::string& word) {
    const bool plain = !word.empty() && std::all_of(word.begin(), word.end(), [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
               std::string_view("-_./:=,+@%").find(c) != std::string_view::npos;
    });
    if (plain) return word;
    std::string quoted = "'";
    for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return quoted + "'";
}

// Whether the tasks of `before` are the first of `now`, with the same commands.
bool sweepGrew(const Sweep& before, const Sweep& now) {
    if (before.tasks > now.tasks || before.commands.size() != now.commands.size() || before.parameters.size() != now.parameters.size())
        return false;
    for (size_t c = 0; c < now.commands.size(); ++c)
        if (before.commands[c].words != now.commands[c].words) return false;
    for (size_t p = 0; p < now.parameters.size(); ++p)
        if (before.parameters[p].name != now.parameters[p].name ||
            !std::equal(before.parameters[p].values.begin(), before.parameters[p].values.end(), now.parameters[p].values.begin()))
            return false;
    return true;
}

// Whether a folder that holds this entry, and no sweep.json, is another's: a sweep that was killed at its start leaves the others.
bool isForeign(const fs::path& entry) {
    const std::string name = entry.filename().string();
    return name != "tasks" && name != "tasks.txt" && name != "origin.json" && name != "sweep.lock" && !name.starts_with(".rivulet-");
}

// Checks the tasks and adds the files that they read.
Status addScenes(const Sweep& sweep, SweepOrigin& origin) {
    const Result<std::set<std::string>> scenes = checkTasks(sweep);
    if (!scenes) return scenes.error();
    for (const std::string& name : *scenes) origin.scenes.emplace(originName(name, sweep.folder), "");
    return hashScenes(origin);
}

// False: errno says why.
bool locks(const Descriptor& file, bool wait) {
    int locked = -1;
    do {
        locked = ::flock(file.get(), wait ? LOCK_EX : LOCK_EX | LOCK_NB);
    } while (locked != 0 && errno == EINTR);
    return locked == 0;
}

std::string programPath() {
    std::error_code error;
    const fs::path program = fs::read_symlink("/proc/self/exe", error);
    return error ? "rivulet" : program.string();
}

}  // namespace

std::vector<std::string> taskLine(const Sweep& sweep, const SweepFolder& folder, size_t task, int threads) {
    std::vector<std::string> words = {programPath(), "sweep", sweep.file, "--output", folder.path(), "--task", std::to_string(task)};
    if (threads != 1) words.insert(words.end(), {"--threads", std::to_string(threads)});
    return words;
}

std::string shellLine(const std::vector<std::string>& words) {
    std::string line;
    for (const std::string& word : words) line += (line.empty() ? "" : " ") + shellWord(word);
    return line;
}

Status SweepFolder::writeTasks(const Sweep& sweep, int threads) const {
    const std::string list = file("tasks.txt");
    std::string lines;
    for (size_t task = 0; task < sweep.tasks; ++task) lines += shellLine(taskLine(sweep, *this, task, threads)) + '\n';
    const Result<std::string> before = readFile(list);
    return before && *before == lines ? ok() : writeFileAtomic(list, lines);
}

Status SweepFolder::prepare(const Sweep& sweep, std::string_view text, int threads) const {
    SweepOrigin origin{.folder = sweep.folder, .scenes = {}};
    const auto check = [&] {
        const std::vector<fs::path> others = entriesOf(path_);
        if (std::any_of(others.begin(), others.end(), isForeign))
            return Status(badInput(fmt::format("{} exists and is no folder of a sweep; choose another --output", path_)));
        return addScenes(sweep, origin);
    };
    // A sweep that is refused leaves nothing, no lock either.
    const bool checked = !isPrepared();
    if (checked)
        if (Status sound = check(); !sound) return sound;
    if (Status made = makeFolder(path_); !made) return made;
    const Result<Descriptor> lock = lockFile(file("sweep.lock"), true);
    if (!lock) return lock.error();
    if (isPrepared()) return adopt(sweep, text, threads);
    if (!checked)
        if (Status sound = check(); !sound) return sound;
    return write(sweep, text, threads, origin);
}

// Checks that a prepared folder belongs to this sweep. The sweep may have more tasks than when the folder was prepared.
Status SweepFolder::adopt(const Sweep& sweep, std::string_view text, int threads) const {
    const std::string kept = file("sweep.json");
    const Result<std::string> before = readFile(kept);
    if (!before) return before.error();
    Result<SweepOrigin> origin = readOrigin(file("origin.json"));
    if (!origin) return origin.error();
    if (Status same = checkOrigin(*origin, sweep.folder, path_); !same) return same;
    const bool moved = origin->folder != sweep.folder;
    origin->folder = sweep.folder;
    if (*before == text) return moved ? write(sweep, text, threads, *origin) : writeTasks(sweep, threads);
    if (const Result<Sweep> old = readSweep(*before, kept); !old || !sweepGrew(*old, sweep))
        return badInput(
            fmt::format("{} has changed since its tasks in {} were made, and not only by more tasks at the end; choose another "
                        "--output, or delete the folder",
                        sweep.file, path_));
    if (Status added = addScenes(sweep, *origin); !added) return added;
    return write(sweep, text, threads, *origin);
}

Status SweepFolder::write(const Sweep& sweep, std::string_view text, int threads, const SweepOrigin& origin) const {
    if (Status made = makeFolder(file("tasks")); !made) return made;
    if (Status written = writeTasks(sweep, threads); !written) return written;
    if (Status written = writeOrigin(origin, file("origin.json")); !written) return written;
    return writeFileAtomic(file("sweep.json"), text);
}

bool SweepFolder::isPrepared() const {
    std::error_code none;
    return fs::exists(file("sweep.json"), none);
}

Result<Sweep> SweepFolder::prepared() const {
    const std::string name = file("sweep.json");
    const Result<std::string> text = readFile(name);
    if (!text) return text.error();
    Result<Sweep> sweep = readSweep(*text, name);
    if (!sweep) return sweep;
    const Result<SweepOrigin> origin = readOrigin(file("origin.json"));
    if (!origin) return origin.error();
    sweep->folder = origin->folder;
    if (Status same = checkOrigin(*origin, sweep->folder, path_); !same) return same.error();
    return sweep;
}

bool SweepFolder::hasEnded(size_t task) const {
    std::error_code none;
    return fs::exists(ended(task), none);
}

std::vector<size_t> SweepFolder::endedTasks() const {
    std::vector<size_t> tasks;
    for (const fs::path& path : entriesOf(file("tasks"))) {
        const std::string name = path.filename().string();
        size_t task = 0;
        if (parseNumber(name, task)) tasks.push_back(task);
    }
    std::sort(tasks.begin(), tasks.end());
    return tasks;
}

Result<Descriptor> SweepFolder::lock(size_t task, bool wait) const { return lockFile(ended(task) + ".lock", wait); }

bool SweepFolder::isHeld(size_t task) const {
    const Descriptor file = openDescriptor(ended(task) + ".lock", O_RDWR);
    return file.valid() && !hasEnded(task) && !locks(file, false) && errno == EWOULDBLOCK;
}

void SweepFolder::removeLock(size_t task) const { (void)::unlink((ended(task) + ".lock").c_str()); }

Result<Descriptor> lockFile(const std::string& name, bool wait) {
    Descriptor file = openDescriptor(name, O_RDWR | O_CREAT);
    if (file.valid() && locks(file, wait)) return file;
    if (file.valid() && errno == EWOULDBLOCK) return Descriptor();
    return failed(fmt::format("{} cannot be locked: {}", name, reasonOf(errno)));
}

}  // namespace rivulet
