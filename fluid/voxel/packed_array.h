// Arrays of plain numbers to compressed bytes (zstd) and back. Unpacking checks everything: memory grows with the bytes unpacked so far.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "engine/core/result.h"

namespace rivulet {

// XXH3, 64 bits. `seed`: the checksum of the bytes before.
uint64_t checksum(std::span<const std::byte> bytes, uint64_t seed = 0);

// The most bytes that `packed` bytes of one zstd frame can hold: a block of at most 128 KiB takes at least 4.
inline constexpr size_t kMostBytesPerPackedByte = 32768;

// Appends one compressed frame to `out`: any number of put(), then finish(). Throws std::bad_alloc.
class ArrayPacker {
  public:
    explicit ArrayPacker(std::string& out);
    ~ArrayPacker();
    ArrayPacker(const ArrayPacker&) = delete;
    ArrayPacker& operator=(const ArrayPacker&) = delete;

    template <class T>
    void put(std::span<const T> items) {
        static_assert(std::is_trivially_copyable_v<T>);
        feed(std::as_bytes(items), false);
    }
    void finish();

  private:
    void feed(std::span<const std::byte> bytes, bool last);
    struct Impl;
    std::unique_ptr<Impl> impl_;
    std::string& out_;
};

// Reads the same arrays, in the same order and of the same types, from one frame. Throws std::bad_alloc.
class ArrayUnpacker {
  public:
    explicit ArrayUnpacker(std::span<const std::byte> packed);
    ~ArrayUnpacker();
    ArrayUnpacker(const ArrayUnpacker&) = delete;
    ArrayUnpacker& operator=(const ArrayUnpacker&) = delete;

    // False: the bytes are not such an array, and why() gives the reason. `to` then has at most twice as many items as the bytes held.
    template <class T>
    bool take(size_t count, std::vector<T>& to) {
        static_assert(std::is_trivially_copyable_v<T>);
        to.clear();
        while (to.size() < count) {
            const size_t first = to.size();
            to.resize(first + std::min(count - first, std::max(first, kFirstBytes / sizeof(T))));
            if (!takeBytes(std::as_writable_bytes(std::span(to).subspan(first)))) return false;
        }
        return true;
    }
    bool finish();  // false: bytes are left over
    const char* why() const { return why_; }

  private:
    static constexpr size_t kFirstBytes = size_t{1} << 18U;
    bool takeBytes(std::span<std::byte> bytes);
    struct Impl;
    std::unique_ptr<Impl> impl_;
    const char* why_ = "";
};

}  // namespace rivulet
