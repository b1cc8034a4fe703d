// Parallel loops on the threads of oneTBB. In builds with ThreadSanitizer, on threads of their own: oneTBB is not compiled with
// ThreadSanitizer, which therefore cannot see how it synchronizes its threads and would report races that do not exist.
#pragma once

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/blocked_range2d.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <thread>
#include <utility>
#include <vector>

#include "engine/core/sanitized.h"

namespace rivulet {

// For builds with ThreadSanitizer. `finest`: the range is split down to its grain size; otherwise into about 16 parts. A loop inside a part
// runs on the thread of that part.
template <class Range, class Body>
void onOwnThreads(const Range& range, const Body& body, bool finest) {
    thread_local bool within = false;
    std::vector<Range> parts = {range};
    for (size_t k = 0; k < parts.size() && (finest || parts.size() < 16);)
        if (parts[k].is_divisible())
            parts.push_back(Range(parts[k], tbb::split()));
        else
            ++k;
    std::atomic<size_t> next = 0;
    std::atomic_flag failed;
    std::exception_ptr thrown;
    const auto work = [&] {
        const bool outer = std::exchange(within, true);
        try {
            for (size_t k = 0; (k = next.fetch_add(1, std::memory_order_relaxed)) < parts.size();) body(parts[k]);
        } catch (...) {
            if (!failed.test_and_set()) thrown = std::current_exception();
        }
        within = outer;
    };
    {
        const int most = within ? 1 : std::min(4, tbb::this_task_arena::max_concurrency());
        std::vector<std::jthread> others;
        for (int k = 1; k < most; ++k) others.emplace_back(work);
        work();
    }
    if (thrown) std::rethrow_exception(thrown);
}

// Splits `range` (tbb::blocked_range or blocked_range2d) by its grain size and runs `body` for each part.
template <class Range, class Body, class... Partitioner>
void parallelRanges(const Range& range, const Body& body, const Partitioner&... partitioner) {
    if constexpr (kThreadSanitized)
        onOwnThreads(range, body, sizeof...(Partitioner) > 0);
    else
        tbb::parallel_for(range, body, partitioner...);
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
