// Loops over the threads of oneTBB. ThreadSanitizer sees what they order: a library that it has not compiled hides that from it.
#pragma once

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/blocked_range2d.h>
#include <oneapi/tbb/parallel_for.h>

#include <cstddef>

#if defined(__SANITIZE_THREAD__)
#define RIVULET_THREAD_SANITIZER 1
#elif defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define RIVULET_THREAD_SANITIZER 1
#endif
#endif
#ifdef RIVULET_THREAD_SANITIZER
extern "C" void __tsan_acquire(void* address);  // NOLINT(bugprone-reserved-identifier,readability-identifier-naming)
extern "C" void __tsan_release(void* address);  // NOLINT(bugprone-reserved-identifier,readability-identifier-naming)
#endif

namespace rivulet {

// What comes before a loop happens before each of its pieces, and each piece before what comes after the loop. The pieces are not ordered.
class LoopOrder {
  public:
#ifdef RIVULET_THREAD_SANITIZER
    LoopOrder() { __tsan_release(&begun_); }
    ~LoopOrder() { __tsan_acquire(&ended_); }
    void begin() const { __tsan_acquire(&begun_); }
    void end() const { __tsan_release(&ended_); }
    LoopOrder(const LoopOrder&) = delete;
    LoopOrder& operator=(const LoopOrder&) = delete;

  private:
    mutable char begun_ = 0, ended_ = 0;
#else
    void begin() const {}
    void end() const {}
#endif
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
