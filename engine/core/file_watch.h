// FileWatch: which files have been written since somebody last looked. It looks at times and sizes, so that any file system will do.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace rivulet {

class FileWatch {
  public:
    // A file, or a folder with all that is in it. As it is now is as it was seen; watched already, it is seen anew.
    void watch(const std::string& path);
    void forget(const std::string& path);

    // Each file that is another than it was, once it has kept still from one call to the next: a file that is being written does not. One
    // that is gone, as between the two steps of an editor that saves by renaming, is as it was.
    std::vector<std::string> changed();

  private:
    struct Stamp {
        int64_t seconds = 0, nanoseconds = 0, bytes = 0;  // when it was written, and how much
        uint64_t inode = 0;                               // another where a file was renamed to this
        bool operator==(const Stamp&) const = default;
    };
    using Stamps = std::map<std::string, Stamp>;
    static void look(const std::string& path, Stamps& into);

    std::map<std::string, Stamps> seen_;  // of each path that is watched
    Stamps moving_;                       // others than those seen, when last looked at
};

}  // namespace rivulet
