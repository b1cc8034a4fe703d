// FileWatch: reports the files that were written since the last call. It compares times and sizes, so it works on any file system.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace rivulet {

class FileWatch {
  public:
    // Watches a file, or a folder with everything in it. Its present state is the reference; a second call takes a new reference.
    void watch(const std::string& path);
    void forget(const std::string& path);

    // The files that differ from their reference, which is then updated. A file is reported once its state is the same in two calls in a
    // row, so that no half-written file is reported. A missing file counts as unchanged: some editors save by renaming.
    std::vector<std::string> changed();

  private:
    struct Stamp {
        int64_t seconds = 0, nanoseconds = 0, bytes = 0;  // time of the last write; size
        uint64_t inode = 0;                               // changes if another file was renamed to this name
        bool operator==(const Stamp&) const = default;
    };
    using Stamps = std::map<std::string, Stamp>;
    static std::optional<Stamp> stampOf(const std::filesystem::path& file);  // nothing: not a regular file
    static void scan(const std::string& path, Stamps& into);

    std::map<std::string, Stamps> reference_;  // by watched path
    Stamps pending_;                           // files that differed from their reference in the last call
};

}  // namespace rivulet
