#include "engine/core/file_watch.h"

#include <filesystem>

#include "engine/core/folder.h"

#if !defined(_WIN32)
#include <sys/stat.h>
#endif

namespace rivulet {

namespace fs = std::filesystem;

#if defined(_WIN32)
std::optional<FileWatch::Stamp> FileWatch::stampOf(const fs::path& file) {
    std::error_code error;
    if (!fs::is_regular_file(file, error)) return std::nullopt;
    const auto written = fs::last_write_time(file, error).time_since_epoch().count();
    return Stamp{0, written, static_cast<int64_t>(fs::file_size(file, error)), 0};
}
#else
// One stat() a file: hundreds of files are checked several times a second.
std::optional<FileWatch::Stamp> FileWatch::stampOf(const fs::path& file) {
    struct stat found = {};
    if (::stat(file.c_str(), &found) != 0 || !S_ISREG(found.st_mode)) return std::nullopt;
    return Stamp{found.st_mtim.tv_sec, found.st_mtim.tv_nsec, found.st_size, found.st_ino};
}
#endif

void FileWatch::scan(const std::string& path, Stamps& into) {
    const auto add = [&into](const fs::path& file) {
        if (const std::optional<Stamp> stamp = stampOf(file)) into[file.string()] = *stamp;
    };
    std::error_code error;
    if (!fs::is_directory(path, error)) return add(path);
    for (const fs::path& entry : entriesOf(path))
        if (fs::is_directory(fs::symlink_status(entry, error)))
            scan(entry.string(), into);
        else
            add(entry);
}

void FileWatch::watch(const std::string& path) {
    Stamps& seen = reference_[path];
    seen.clear();
    scan(path, seen);
    for (const auto& [file, stamp] : seen) pending_.erase(file);
}

void FileWatch::forget(const std::string& path) { reference_.erase(path); }

std::vector<std::string> FileWatch::changed() {
    std::vector<std::string> found;
    Stamps pending;
    for (auto& [path, seen] : reference_) {
        Stamps now;
        scan(path, now);
        for (const auto& [file, stamp] : now) {
            const auto before = seen.find(file);
            if (before != seen.end() && before->second == stamp) continue;
            const auto last = pending_.find(file);
            if (last == pending_.end() || last->second != stamp) {
                pending[file] = stamp;
                continue;
            }
            seen[file] = stamp;
            found.push_back(file);
        }
    }
    pending_ = std::move(pending);
    return found;
}

}  // namespace rivulet
