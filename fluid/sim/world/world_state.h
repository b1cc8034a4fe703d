// The whole state of a world as named sections of plain numbers, and as a file (.rstate): what is saved is what the next step depends on.
// Each part puts sections under names of its own and takes them back; a section that is missing or remains is an Error.
//
// The file: 40 bytes of header, 64 a section, then the sections one after the other, each one zstd frame (packed_array.h), in the byte
// order of the machine that wrote it. XXH3 checks the header with the table, and each section.
#pragma once

#include <cstddef>
#include <cstring>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/json.h"
#include "engine/core/result.h"

namespace rivulet {

class WorldState {
  public:
    using Bytes = std::vector<std::byte>;
    static constexpr size_t kLongestName = 31;

    template <class T>
    void put(const std::string& name, std::span<const T> items) {
        static_assert(std::is_trivially_copyable_v<T>);
        const auto bytes = std::as_bytes(items);
        putBytes(name, {bytes.begin(), bytes.end()});
    }
    void putText(const std::string& name, std::string_view text) { put<char>(name, text); }

    // Exactly `count` items. Error (badInput): there is no such section, or it holds more or less.
    template <class T>
    Result<std::vector<T>> take(const std::string& name, size_t count) {
        static_assert(std::is_trivially_copyable_v<T>);
        Result<Bytes> bytes = takeBytes(name);
        if (!bytes) return bytes.error();
        if (bytes->size() != count * sizeof(T)) return otherSize(name, bytes->size(), count * sizeof(T));
        std::vector<T> items(count);
        if (count > 0) std::memcpy(items.data(), bytes->data(), bytes->size());
        return items;
    }
    Result<std::string> takeText(const std::string& name);
    // Error (badInput): a section that was not taken, of a part that this world does not have.
    Status allTaken() const;

    const std::map<std::string, Bytes>& sections() const { return sections_; }
    void putBytes(const std::string& name, Bytes bytes);

    // Of any size.
    Result<Bytes> takeBytes(const std::string& name);

  private:
    static Error otherSize(const std::string& name, size_t bytes, size_t expected);
    std::map<std::string, Bytes> sections_;  // in the order of their names
};

// The Params that are `fixed`, a line each: "fluid.spacing = 0.02". What a state can be resumed with must have the same.
std::string fixedValues(const VisitFn& visit);
// Error (badInput): names the first line that differs. A parameter that `saved` lacks in a group that it has, or a group that it lacks, was
// added by a later version, and may have any value.
Status sameFixedValues(std::string_view saved, std::string_view now);

// Error (failed): out of memory.
Result<std::string> packState(const WorldState& state);
// `name` is what errors call the file. Error (badInput: what is wrong, and what to do; failed: out of memory): whatever the bytes are.
Result<WorldState> unpackState(std::span<const std::byte> bytes, std::string_view name, size_t memoryLimit = size_t{16} << 30U);

// To and from a file, which appears whole under its name or not at all. The bytes written. Error also: not writable, not readable.
Result<size_t> writeState(const std::string& path, const WorldState& state);
Result<WorldState> readState(const std::string& path);

}  // namespace rivulet
