// The loops over a group's neighbours on the CPU, over the list that fluid/sim/grid/neighbor_grid.cpp built for it. The same names on a
// GPU: shaders/fluid/grid/neighbors.h. Part of lang_cpp.h, which includes it after lang_lanes.h.
#pragma once

#define NEIGHBOR_TYPE NeighborLists
#define NEIGHBORS_KEPT(b, RO, RW) RO(b, Neighbors, NEIGHBOR_TYPE, neighbors)
#define SELF(i) const Group& i = neighbors->groups[THREAD_ID]
#define SELF_SAMPLE(i) const Group& i = neighbors->samples[THREAD_ID]
#define FOR_NEIGHBORS(i, home, j)                          \
    {                                                      \
        const uint* list_ = neighbors->list + i.listBegin; \
        const uint n_ = i.listCount;                       \
        for (uint k_ = 0; k_ < n_; ++k_) {                 \
            const uint j = list_[k_];
#define END_NEIGHBORS \
    }                 \
    }
// FOR_NEIGHBORS between FOR_IMAGES and END_IMAGES.
#define FOR_SEEN(i, home, j)                                       \
    {                                                              \
        const uint* list_ = neighbors->list + i.listBegin;         \
        const uint n_ = IMAGE > 0 ? i.seenCount : i.listCount;     \
        for (uint k_ = 0; k_ < n_; ++k_) {                         \
            const uint j = list_[k_];
// FOR_SEEN in a step's first sweep: the list keeps only the entries for which KEEP's condition holds in some lane, those of which an image
// may be seen (a bool) before the others. Each entry is written, and overwritten by the next one if
// it is not kept: a branch instead would be mispredicted often.
#define FOR_ALL_SEEN(i, home, j)                                   \
    {                                                              \
        uint* list_ = neighbors->list + i.listBegin;               \
        const uint n_ = IMAGE > 0 ? i.seenCount : i.listCount;     \
        uint kept_ = 0, seen_ = 0;                                 \
        for (uint k_ = 0; k_ < n_; ++k_) {                         \
            const uint j = list_[k_];
#define KEEP(condition, seen)                   \
    if (IMAGE == 0) {                           \
        const bool some_ = anyLane(condition);  \
        list_[kept_] = j;                       \
        if (some_ & (seen)) {                   \
            list_[kept_] = list_[seen_];        \
            list_[seen_] = j;                   \
            ++seen_;                            \
        }                                       \
        kept_ += some_ ? 1u : 0u;               \
    }
#define END_ALL_SEEN(i)                              \
    }                                                \
    if (IMAGE == 0) {                                \
        const_cast<Group&>(i).listCount = kept_;     \
        const_cast<Group&>(i).seenCount = seen_;     \
    }                                                \
    }
