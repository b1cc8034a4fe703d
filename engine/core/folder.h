// What a folder holds.
#pragma once

#include <filesystem>
#include <vector>

namespace rivulet {

// The paths of a folder's entries without `.` and `..`, in no particular order; empty if it cannot be read. Throws std::bad_alloc if memory
// runs out, where std::filesystem::directory_iterator of libstdc++ 12 calls std::terminate.
std::vector<std::filesystem::path> entriesOf(const std::filesystem::path& folder);

}  // namespace rivulet
