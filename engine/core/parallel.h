// Parallel loops on the jobs of the calling thread (jobs.h).
#pragma once

#include <algorithm>
#include <cstddef>

#include "engine/core/jobs.h"

namespace rivulet {

// Runs body(begin, end) for the parts of [0, count) that are `grain` long, the last one shorter.
template <class Body>
void parallelParts(size_t count, size_t grain, const Body& body) {
    runLoop(
        count, grain, [](const void* context, size_t begin, size_t end) { (*static_cast<const Body*>(context))(begin, end); }, &body);
}

// Runs `body(k)` for k from `first` to `end` - 1.
template <class Index, class Body>
void parallelFor(Index first, Index end, const Body& body) {
    if (!(first < end)) return;
    const auto count = static_cast<size_t>(end - first);
    // Some parts for each worker: those that finish early take over from the others.
    const size_t grain = std::max<size_t>(1, count / (16 * static_cast<size_t>(jobWorkers())));
    parallelParts(count, grain, [&](size_t begin, size_t stop) {
        for (size_t k = begin; k < stop; ++k) body(static_cast<Index>(first + static_cast<Index>(k)));
    });
}

}  // namespace rivulet
