// FileWatch with one stat() per file: hundreds of files are checked several times a second.
#include "engine/core/file_watch.h"

#include <sys/stat.h>

#include <filesystem>

#include "engine/core/folder.h"

namespace rivulet {

namespace fs = std::filesystem;

void FileWatch::scan(const std::string& path, Stamps& into) {
    const auto add = [&into](const fs::path& file) {
        struct stat found = {};
        if (::stat(file.c_str(), &found) == 0 && S_ISREG(found.st_mode))
            into[file.string()] = {found.st_mtim.tv_sec, found.st_mtim.tv_nsec, found.st_size, found.st_ino};
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
