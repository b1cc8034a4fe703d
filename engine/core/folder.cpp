#include "engine/core/folder.h"

#include <dirent.h>

#include <memory>
#include <string_view>

namespace rivulet {

std::vector<std::filesystem::path> entriesOf(const std::filesystem::path& folder) {
    struct Close {
        void operator()(DIR* open) const { ::closedir(open); }
    };
    std::vector<std::filesystem::path> paths;
    const std::unique_ptr<DIR, Close> open(::opendir(folder.c_str()));
    if (!open) return paths;
    while (const dirent* entry = ::readdir(open.get())) {
        const std::string_view name = entry->d_name;
        if (name != "." && name != "..") paths.push_back(folder / name);
    }
    return paths;
}

}  // namespace rivulet
