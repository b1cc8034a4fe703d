#include "engine/compute/disk_cache.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "engine/core/file.h"
#include "engine/core/folder.h"
#include "engine/core/private_file.h"

namespace rivulet {

namespace {

namespace fs = std::filesystem;

// A file holds this header, the key and the data. The whole key is stored, because two keys may have the same hash.
struct Header {
    std::array<char, 8> magic;
    uint64_t keyBytes, dataBytes;
    uint64_t checksum;  // XXH3 of key and data
};
constexpr std::array<char, 8> kMagic = {'R', 'V', 'L', 'T', 'K', 'P', '0', '1'};
constexpr const char* kEnding = ".kept";

}  // namespace

void trimCache(const std::string& folder, std::string_view ending, size_t mostFiles, size_t mostBytes) {
    struct Entry {
        fs::path path;
        fs::file_time_type used;
        size_t bytes;
    };
    std::vector<Entry> entries;
    std::error_code ignored;
    const auto longAgo = fs::file_time_type::clock::now() - std::chrono::hours(1);
    size_t total = 0;
    for (const fs::path& path : entriesOf(folder)) {
        std::error_code gone;  // deleted by another process
        Entry entry{path, fs::last_write_time(path, gone), 0};
        if (!gone) entry.bytes = static_cast<size_t>(fs::file_size(path, gone));
        if (gone) continue;
        if (entry.path.extension() == ".tmp" && entry.used < longAgo) fs::remove(entry.path, gone);
        if (entry.path.extension() != ending) continue;
        total += entry.bytes;
        entries.push_back(entry);
    }
    std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) { return a.used < b.used; });
    size_t files = entries.size();
    for (const Entry& entry : entries) {
        if (files <= mostFiles && total <= mostBytes) return;
        fs::remove(entry.path, ignored);
        total -= entry.bytes;
        --files;
    }
}

std::string cacheFolder(std::string_view name) {
    for (const auto& [variable, below] :
         {std::pair("XDG_CACHE_HOME", "rivulet"), std::pair("HOME", ".cache/rivulet"), std::pair("LOCALAPPDATA", "rivulet")}) {
        const char* root = std::getenv(variable);
        if (root != nullptr && fs::path(root).is_absolute()) return (fs::path(root) / below / name).string();
    }
    return {};
}

std::string hashOf(std::span<const std::byte> bytes) {
    const XXH128_hash_t hash = XXH3_128bits(bytes.data(), bytes.size());
    return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

DiskCache::DiskCache(std::string folder, Log log) : folder_(std::move(folder)), log_(std::move(log)) {
    if (folder_.empty()) return;
    const Status trusted = checkPrivateFolder(folder_);
    if (trusted) return;
    log_.notice(fmt::format("the cache is not used: {}", trusted.error().message));
    folder_.clear();
}

std::string DiskCache::pathOf(std::string_view key) const {
    return (fs::path(folder_) / (hashOf(std::as_bytes(std::span(key))) + kEnding)).string();
}

std::optional<std::vector<std::byte>> DiskCache::find(std::string_view key) const {
    if (folder_.empty()) return std::nullopt;
    const fs::path path = pathOf(key);
    std::error_code ignored;
    if (!fs::is_regular_file(path, ignored)) return std::nullopt;
    if (Status trusted = checkPrivateFile(path.string()); !trusted) {
        log_.notice(fmt::format("an entry of the cache is made again: {}", trusted.error().message));
        return std::nullopt;
    }
    const Result<std::string> file = readFile(path.string(), kMostBytes);
    Header header{};
    if (!file || file->size() < sizeof header) return std::nullopt;
    std::memcpy(&header, file->data(), sizeof header);
    const std::string_view rest = std::string_view(*file).substr(sizeof header);
    if (header.magic != kMagic || header.keyBytes != key.size() || rest.size() < key.size() ||
        header.dataBytes != rest.size() - key.size() || header.checksum != XXH3_64bits(rest.data(), rest.size()) ||
        rest.substr(0, key.size()) != key)
        return std::nullopt;
    fs::last_write_time(path, fs::file_time_type::clock::now(), ignored);  // the time of the last use, for trimCache
    const auto data = std::as_bytes(std::span(rest.substr(key.size())));
    return std::vector<std::byte>(data.begin(), data.end());
}

void DiskCache::keep(std::string_view key, std::span<const std::byte> data) const {
    if (folder_.empty() || data.empty() || sizeof(Header) + key.size() + data.size() > kMostBytes) return;
    std::string file(sizeof(Header), '\0');
    file += key;
    file.append(reinterpret_cast<const char*>(data.data()), data.size());
    const Header header{kMagic, key.size(), data.size(), XXH3_64bits(file.data() + sizeof(Header), file.size() - sizeof(Header))};
    std::memcpy(file.data(), &header, sizeof header);
    if (makePrivateFolder(folder_) && writePrivateFile(pathOf(key), file)) trimCache(folder_, kEnding, kMostFiles, kMostBytes);
}

}  // namespace rivulet
