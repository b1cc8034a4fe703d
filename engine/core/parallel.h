// Loops over the threads of oneTBB. ThreadSanitizer sees what they order: a library that it has not compiled hides that from it.
#pragma once

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/blocked_range2d.h>
#include <oneapi/tbb/parallel_for.h>

#include <cstddef>

#include "engine/core/sanitized.h"

// Of ThreadSanitizer, in builds that have it.
extern "C" void __tsan_acquire(void* address);  // NOLINT(bugprone-reserved-identifier,readability-identifier-naming)
extern "C" void __tsan_release(void* address);  // NOLINT(bugprone-reserved-identifier,readability-identifier-naming)

namespace rivulet {

// What comes before a loop happens before each of its pieces, and each piece before what comes after the loop. The pieces are not ordered.
class LoopOrder {
  public:
    LoopOrder() { release(begun_); }
    ~LoopOrder() { acquire(ended_); }
    void begin() const { acquire(begun_); }
    void end() const { release(ended_); }
    LoopOrder(const LoopOrder&) = delete;
    LoopOrder& operator=(const LoopOrder&) = delete;

  private:
    static void acquire(char& mark) {
        if constexpr (kThreadSanitized) __tsan_acquire(&mark);
    }
    static void release(char& mark) {
        if constexpr (kThreadSanitized) __tsan_release(&mark);
    }
    mutable char begun_ = 0, ended_ = 0;
};

// Splits `range` (tbb::blocked_range or blocked_range2d) by its grain size and runs `body` for each part.
template <class Range, class Body, class... Partitioner>
void parallelRanges(const Range& range, const Body& body, const Partitioner&... partitioner) {
    const LoopOrder order;
    tbb::parallel_for(
        range,
        [&](const Range& part) {
            order.begin();
            body(part);
            order.end();
        },
        partitioner...);
}

// Runs `body(k)` for k from `first` to `end` - 1.
template <class Index, class Body, class... Partitioner>
void parallelFor(Index first, Index end, const Body& body, const Partitioner&... partitioner) {
    if (!(first < end)) return;
    parallelRanges(
        tbb::blocked_range<Index>(first, end),
        [&](const tbb::blocked_range<Index>& part) {
            for (Index k = part.begin(); k != part.end(); ++k) body(k);
        },
        partitioner...);
}

}  // namespace rivulet
