#include <system_error>

#include "engine/core/folder.h"

namespace rivulet {

std::vector<std::filesystem::path> entriesOf(const std::filesystem::path& folder) {
    std::vector<std::filesystem::path> paths;
    std::error_code error;
    for (std::filesystem::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) paths.push_back(at->path());
    return paths;
}

}  // namespace rivulet
