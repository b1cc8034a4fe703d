// FileWatch: one stat() a file, as hundreds are asked some times a second.
#include "engine/core/file_watch.h"

#include <sys/stat.h>

#include <filesystem>

namespace rivulet {

namespace fs = std::filesystem;

void FileWatch::look(const std::string& path, Stamps& into) {
    const auto take = [&into](const fs::path& file) {
        struct stat found = {};
        if (::stat(file.c_str(), &found) == 0 && S_ISREG(found.st_mode))
            into[file.string()] = {found.st_mtim.tv_sec, found.st_mtim.tv_nsec, found.st_size, found.st_ino};
    };
    std::error_code error;
    if (!fs::is_directory(path, error)) return take(path);
    for (fs::recursive_directory_iterator at(path, error), end; !error && at != end; at.increment(error)) take(at->path());
}

void FileWatch::watch(const std::string& path) {
    Stamps& seen = seen_[path];
    seen.clear();
    look(path, seen);
    for (const auto& [file, stamp] : seen) moving_.erase(file);
}

void FileWatch::forget(const std::string& path) { seen_.erase(path); }

std::vector<std::string> FileWatch::changed() {
    std::vector<std::string> found;
    Stamps moving;
    for (auto& [path, seen] : seen_) {
        Stamps now;
        look(path, now);
        for (const auto& [file, stamp] : now) {
            const auto before = seen.find(file);
            if (before != seen.end() && before->second == stamp) continue;
            const auto last = moving_.find(file);
            if (last == moving_.end() || last->second != stamp) {
                moving[file] = stamp;
                continue;
            }
            seen[file] = stamp;
            found.push_back(file);
        }
    }
    moving_ = std::move(moving);
    return found;
}

}  // namespace rivulet
