// Compiled programs kept on the disk: the second start of a scene loads what the first one built.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace rivulet {

// $XDG_CACHE_HOME/rivulet/cl, else ~/.cache/rivulet/cl; "" where neither variable holds an absolute path: nothing is kept then.
std::string programCacheFolder();

// A folder of programs, each known by all that it was made of. What cannot be read is a miss, what cannot be written is not kept: neither
// is an error, and nobody is told. Any number of processes may share a folder.
class ProgramCache {
  public:
    // Used longest ago goes first.
    static constexpr size_t kMostFiles = 256, kMostBytes = size_t{64} << 20U;

    explicit ProgramCache(std::string folder) : folder_(std::move(folder)) {}  // "": nothing is kept

    // The program of exactly this key, whole as it was kept, or nothing.
    std::optional<std::vector<std::byte>> find(std::string_view key) const;
    void keep(std::string_view key, std::span<const std::byte> program) const;
    // The file that a key's program is in, or would be.
    std::string pathOf(std::string_view key) const;

  private:
    std::string folder_;
};

}  // namespace rivulet
