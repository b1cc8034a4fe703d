// Structs that begin with their size: a program built against an older or a newer rivulet.h and this library read the members that both
// have.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <string>

#include "engine/core/result.h"
#include "fluid/capi/rivulet.h"

namespace rivulet::capi {

// The size that a caller's struct begins with. `type` and `name` are for the error (badInput): no version of the struct has that size, for
// example because it was not set or is the size of a pointer.
inline Result<size_t> sizeOf(const void* given, const char* type, const std::string& name) {
    constexpr size_t kMost = 4096;
    size_t size = 0;
    std::memcpy(&size, given, sizeof size);
    if (size <= sizeof size || size > kMost) return badInput(fmt::format("{}.size is {}: set it to sizeof({})", name, size, type));
    return size;
}

// A struct that the caller filled, of any version: members that its header does not have are 0. Errors as sizeOf; (badInput): it sets
// members that this library does not have.
template <class T>
Result<T> readStruct(const T* given, const char* type, const std::string& name) {
    T full{};
    if (given == nullptr) return full;
    const Result<size_t> size = sizeOf(given, type, name);
    if (!size) return size.error();
    std::memcpy(static_cast<void*>(&full), given, std::min(*size, sizeof(T)));
    const auto* bytes = reinterpret_cast<const unsigned char*>(given);
    if (std::any_of(bytes + std::min(*size, sizeof(T)), bytes + *size, [](unsigned char b) { return b != 0; }))
        return badInput(
            fmt::format("{} sets members of a later rivulet.h, and this library is version {}; set them to 0, or use a later library", name,
                        rivulet_version()));
    return full;
}

// Fills a caller's struct, of any version: members that its header does not have are left out. Error (badInput): as sizeOf, or NULL.
template <class T>
Status writeStruct(T full, T* to, const char* type, const std::string& name) {
    if (to == nullptr) return badInput(name + " is NULL");
    const Result<size_t> size = sizeOf(to, type, name);
    if (!size) return size.error();
    full.size = *size;
    std::memcpy(static_cast<void*>(to), &full, std::min(*size, sizeof(T)));
    return ok();
}

}  // namespace rivulet::capi
