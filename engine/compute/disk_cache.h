// A cache on disk for results that take long to compute: the second start of a scene loads what the first one computed.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/log.h"

namespace rivulet {

// $XDG_CACHE_HOME/rivulet/NAME, else ~/.cache/rivulet/NAME; "" if neither variable holds an absolute path: then nothing is stored.
std::string cacheFolder(std::string_view name);

// The hash of `bytes` as 32 hexadecimal digits (XXH3, 128 bits): a short key for large data.
std::string hashOf(std::span<const std::byte> bytes);

// Deletes the least recently used files with this ending until at most `mostFiles` files and `mostBytes` bytes remain. Also deletes
// temporary files older than an hour, which crashed programs left behind.
void trimCache(const std::string& folder, std::string_view ending, size_t mostFiles, size_t mostBytes);

// A folder of entries, each with a key that states all its inputs. An entry that cannot be read is a miss; one that cannot be written is
// not stored; neither is reported. A folder or an entry that others may have written is not used (private_file.h); that is a notice. Any
// number of processes of one user may share a folder.
class DiskCache {
  public:
    // Limits of the folder: the least recently used entries are deleted first.
    static constexpr size_t kMostFiles = 256, kMostBytes = size_t{64} << 20U;

    explicit DiskCache(std::string folder, Log log = {});  // "": nothing is stored

    // The data of exactly this key, checked by its checksum; empty: none.
    std::optional<std::vector<std::byte>> find(std::string_view key) const;
    void keep(std::string_view key, std::span<const std::byte> data) const;
    // The path of the file of `key`, whether it exists or not.
    std::string pathOf(std::string_view key) const;

  private:
    std::string folder_;
    Log log_;
};

}  // namespace rivulet
