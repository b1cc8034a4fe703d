// What takes long to make kept on the disk: the second start of a scene loads what the first one made.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace rivulet {

// $XDG_CACHE_HOME/rivulet/NAME, else ~/.cache/rivulet/NAME; "" where neither variable holds an absolute path: nothing is kept then.
std::string cacheFolder(std::string_view name);

// 32 hexadecimal digits of these bytes (XXH3): for a key of what is large.
std::string hashOf(std::span<const std::byte> bytes);

// Deletes of a folder's files with this ending those used longest ago until the rest fits, and what a program that crashed has left
// half-written.
void trimCache(const std::string& folder, std::string_view ending, size_t mostFiles, size_t mostBytes);

// A folder of things, each known by all that it was made of. What cannot be read is a miss, what cannot be written is not kept: neither
// is an error, and nobody is told. Any number of processes may share a folder.
class DiskCache {
  public:
    // Used longest ago goes first.
    static constexpr size_t kMostFiles = 256, kMostBytes = size_t{64} << 20U;

    explicit DiskCache(std::string folder) : folder_(std::move(folder)) {}  // "": nothing is kept

    // The thing of exactly this key, whole as it was kept, or nothing.
    std::optional<std::vector<std::byte>> find(std::string_view key) const;
    void keep(std::string_view key, std::span<const std::byte> thing) const;
    // The file that a key's thing is in, or would be.
    std::string pathOf(std::string_view key) const;

  private:
    std::string folder_;
};

}  // namespace rivulet
