// Large pages for large memory. The system hands out memory in pages of 4 KiB, on first touch, at a microsecond or more each: for millions
// of particles that is a large part of a start, and of the end too, when the pages go back.
#pragma once

#include <cstddef>
#include <vector>

#include "engine/core/abi.h"

namespace rivulet {

// Asks the system for large pages in this memory, from the next first touch on. A request, never an obligation: where the system has none,
// and for memory of less than some MiB, nothing happens.
void useLargePages(void* memory, size_t bytes);

// vector.reserve(count), in large pages.
template <class T>
void reserveLarge(std::vector<T>& vector, size_t count) {
    if (count <= vector.capacity()) return;
    std::vector<T> larger;
    larger.reserve(count);
    useLargePages(larger.data(), count * sizeof(T));
    larger.insert(larger.end(), vector.begin(), vector.end());
    vector.swap(larger);
}

// A vector of `count` items with T's default value, in large pages.
template <class T>
std::vector<T> largeVector(size_t count) {
    std::vector<T> made;
    reserveLarge(made, count);
    made.resize(count);
    return made;
}

}  // namespace rivulet
