// Structs that begin with their size: a program built against an older or a newer rivulet.h and this library read what both know.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <string>

#include "engine/core/result.h"
#include "fluid/capi/rivulet.h"

namespace rivulet::capi {

// What a caller's struct says of its own size. `type` and `name`: what an error calls it. Error (badInput): no version of it has that size:
// it was not set, or to the size of a pointer.
inline Result<size_t> sizeOf(const void* given, const char* type, const std::string& name) {
    constexpr size_t kMost = 4096;
    size_t size = 0;
    std::memcpy(&size, given, sizeof size);
    if (size <= sizeof size || size > kMost) return badInput(fmt::format("{}.size is {}: set it to sizeof({})", name, size, type));
    return size;
}

// What a caller filled, of whichever version its header is: what it does not know of is 0. Errors as sizeOf.
template <class T>
Result<T> taken(const T* given, const char* type, const std::string& name) {
    T full{};
    if (given == nullptr) return full;
    const Result<size_t> size = sizeOf(given, type, name);
    if (!size) return size.error();
    std::memcpy(static_cast<void*>(&full), given, std::min(*size, sizeof(T)));
    const auto* bytes = reinterpret_cast<const unsigned char*>(given);
    if (std::any_of(bytes + std::min(*size, sizeof(T)), bytes + *size, [](unsigned char b) { return b != 0; }))
        return badInput(fmt::format("{} asks for what a later rivulet.h has, and this library is {}", name, rivulet_version()));
    return full;
}

// Fills a caller's struct, of whichever version its header is: what it does not know of is left out. Errors as sizeOf, or NULL.
template <class T>
Status handOver(T full, T* to, const char* type, const std::string& name) {
    if (to == nullptr) return badInput(name + " is NULL");
    const Result<size_t> size = sizeOf(to, type, name);
    if (!size) return size.error();
    full.size = *size;
    std::memcpy(static_cast<void*>(to), &full, std::min(*size, sizeof(T)));
    return ok();
}

}  // namespace rivulet::capi
