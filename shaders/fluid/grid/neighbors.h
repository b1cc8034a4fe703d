// The loop over a particle's neighbours on a GPU: the nine rows of cells around it, each with three cells contiguous in memory; with MATTER
// also the same rows of body samples, with SLEEP those of sleeping particles; with PERIODIC (or REPEATS) cell by cell, as rows may wrap;
// with LINKED_LIST the lists of the 27 cells. (On the CPU, lang_neighbors.h defines the same macros over a neighbour list for each group
// of 8.) Needs PARAMS of StepParams and a buffer RO(1, Neighbors, NEIGHBOR_TYPE, neighbors), which on a GPU is cellStart or the lists.
// `home`: the particle's position when the grid was built. j includes the particle itself.
#include "shaders/fluid/grid/kept_pairs.h"
#include "shaders/fluid/grid/linked_list.h"
#if !defined(FOR_NEIGHBORS)
#define SELF(i)         \
    uint i = THREAD_ID; \
    if (STANDS_BY(neighbors, PARAMS.cellCount, i)) return
#define SELF_SAMPLE(i)                                \
    uint i = neighbors[PARAMS.cellCount] + THREAD_ID; \
    if (i >= neighbors[PARAMS.totalCells]) return /* a thread a sample */
#define END_NEIGHBORS \
    }                 \
    }                 \
    }
// The same among images (fluid/solids/images.h). In the first sweep of a step, KEEP marks the neighbours that later sweeps need, and those
// of which images may be seen; a GPU keeps no list.
#define FOR_SEEN(i, home, j) FOR_NEIGHBORS(i, home, j)
#define FOR_ALL_SEEN(i, home, j) FOR_NEIGHBORS(i, home, j)
#define KEEP(condition, seen)
#define END_ALL_SEEN(i) END_NEIGHBORS
#endif
#if !defined(__cplusplus)
#undef FOR_NEIGHBORS
#undef SETS_
#undef AWAKE_SETS_
#undef SET_AT_
#if defined(MATTER)
#define AWAKE_SETS_ (PARAMS.totalCells > PARAMS.cellCount ? 2 : 1)
#else
#define AWAKE_SETS_ 1
#endif
#if defined(SLEEP)
#define SETS_ (AWAKE_SETS_ + 1)
#define SET_AT_(set) TO_INT((set) == AWAKE_SETS_ ? PARAMS.totalCells + 3u : TO_UINT(set) * PARAMS.cellCount)
#else
#define SETS_ AWAKE_SETS_
#define SET_AT_(set) ((set)*TO_INT(PARAMS.cellCount))
#endif
#if defined(REPEATS)
#include "shaders/fluid/grid/repeats.h"
#define HOME_CELL(home)                                                  \
    vec3 g_ = (home - PARAMS.gridOrigin.xyz) * PARAMS.gridScale.xyz;     \
    int cx_ = repeatedCell(TO_INT(floor(g_.x)), 1, PARAMS.cellsX - 2);   \
    int cy_ = repeatedCell(TO_INT(floor(g_.y)), 1, PARAMS.cellsY - 2);   \
    int cz_ = repeatedCell(TO_INT(floor(g_.z)), 1, PARAMS.cellsZ - 2);
#else
#define HOME_CELL(home)                                              \
    vec3 g_ = (home - PARAMS.gridOrigin.xyz) * PARAMS.gridScale.xyz; \
    int cx_ = TO_INT(g_.x);                                          \
    int cy_ = TO_INT(g_.y);                                          \
    int cz_ = TO_INT(g_.z);
#endif
#if defined(LINKED_LIST)
#define FOR_NEIGHBORS(i, home, j)                                                                                       \
    {                                                                                                                   \
        HOME_CELL(home)                                                                                                 \
        for (int k_ = 0; k_ < 27; ++k_) {                                                                               \
            int cell_ = ((cz_ + k_ / 9 - 1) * PARAMS.cellsY + cy_ + k_ / 3 % 3 - 1) * PARAMS.cellsX + cx_ + k_ % 3 - 1; \
            for (uint j = neighbors[cell_]; j != LIST_END; j = neighbors[NEXT_OF(PARAMS.cellCount, j)]) {
#elif defined(PERIODIC)
// On a periodic axis cells 1 .. n - 2 wrap around; if there are only two of them, the lower and the upper neighbour are the same cell.
FN int wrapped_(int c, int n, float period) { return period > 0.0f ? (c < 1 ? n - 2 : c > n - 2 ? 1 : c) : c; }
FN int cellsAround_(int n, float period) { return period > 0.0f && n == 4 ? 2 : 3; }
#define ROWS_(home)                                                                                       \
    {                                                                                                     \
        HOME_CELL(home)                                                                                   \
        int nx_ = cellsAround_(PARAMS.cellsX, PARAMS.period.x);                                           \
        int ny_ = cellsAround_(PARAMS.cellsY, PARAMS.period.y);                                           \
        int nz_ = cellsAround_(PARAMS.cellsZ, PARAMS.period.z);                                           \
        for (int row_ = 0; row_ < nx_ * ny_ * nz_ * SETS_; ++row_) {                                      \
            int x_ = wrapped_(cx_ + row_ % nx_ - 1, PARAMS.cellsX, PARAMS.period.x);                      \
            int y_ = wrapped_(cy_ + row_ / nx_ % ny_ - 1, PARAMS.cellsY, PARAMS.period.y);                \
            int z_ = wrapped_(cz_ + row_ / (nx_ * ny_) % nz_ - 1, PARAMS.cellsZ, PARAMS.period.z);        \
            int cell_ = (z_ * PARAMS.cellsY + y_) * PARAMS.cellsX + x_ + SET_AT_(row_ / (nx_ * ny_ * nz_)); \
            uint begin_ = neighbors[cell_];                                                               \
            uint end_ = neighbors[cell_ + 1];
#else
#define ROWS_(home)                                                                                                                \
    {                                                                                                                              \
        HOME_CELL(home)                                                                                                            \
        for (int row_ = 0; row_ < 9 * SETS_; ++row_) {                                                                             \
            int cell_ = ((cz_ + row_ / 3 % 3 - 1) * PARAMS.cellsY + cy_ + row_ % 3 - 1) * PARAMS.cellsX + cx_ + SET_AT_(row_ / 9); \
            uint begin_ = neighbors[cell_ - 1];                                                                                    \
            uint end_ = neighbors[cell_ + 2];
#endif
#endif
// The vector from b to a; with PERIODIC the shortest of its periodic images.
#undef APART
#if defined(PERIODIC)
FN real3 wrapApart(real3 d, vec3 period, vec3 inv) {
    return real3(d.x - floor(d.x * inv.x + 0.5f) * period.x, d.y - floor(d.y * inv.y + 0.5f) * period.y,
                 d.z - floor(d.z * inv.z + 0.5f) * period.z);
}
#define APART(a, b) wrapApart((a) - (b), PARAMS.period.xyz, PARAMS.invPeriod.xyz)
#else
#define APART(a, b) ((a) - (b))
#endif
// FOR_SEEN of pair terms that are zero from the distance h on. `at`: the particle's position, `position`: the buffer of its neighbours'.
// A GPU first finds which of up to 32 neighbours are within h, a sixth of those in the cells, and then computes the terms of these alone:
// all threads of a warp go through the long part for a few neighbours, not for each that one of them has. A bit says that a neighbour is
// within h. FOR_ALL_PAIRS, the first sweep of a step, keeps the bits of the first 64 neighbours in each row behind the entries of
// cellStart, and later sweeps, those for images and further iterations included, load them. FOR_ALL_PAIRS needs NEIGHBORS_KEPT in place of
// the row RO(1, Neighbors, ..). PAIR_REACH: of the bits, over h; more than 1 if particles move between sweeps.
#undef FOR_PAIRS
#undef FOR_ALL_PAIRS
#undef END_PAIRS
#undef END_ALL_PAIRS
#if defined(__cplusplus) || defined(LINKED_LIST)
#define FOR_PAIRS(i, home, at, position, j) FOR_SEEN(i, home, j)
#define FOR_ALL_PAIRS(i, home, at, position, j) FOR_ALL_SEEN(i, home, j)
#define END_PAIRS END_NEIGHBORS
#define END_ALL_PAIRS(i) END_ALL_SEEN(i)
#else
#define FOR_NEIGHBORS(i, home, j) \
    ROWS_(home)                   \
    for (uint j = begin_; j < end_; ++j) {
#if !defined(PAIR_REACH)
#define PAIR_REACH 1.0f
#endif
#define FIND_PAIRS_(at, position)                                                               \
    for (uint b_ = 0u; b_ < many_; ++b_) {                                                      \
        real3 d_ = APART(at, LOAD3(position, first_ + b_));                                     \
        bits_ |= (dot(d_, d_) < PAIR_REACH * PARAMS.h * (PAIR_REACH * PARAMS.h) ? 1u : 0u) << b_; \
    }
#if defined(PERIODIC) || defined(THESIS)  // of single cells there may be 27; the thesis sweeps once: nothing is kept
#define PAIR_BITS_(i, at, position) FIND_PAIRS_(at, position)
#define ALL_PAIR_BITS_(i, at, position) FIND_PAIRS_(at, position)
#else
#define KEPT_AT_(i)                                                                                                \
    bool keeps_ = row_ < KEPT_ROWS && first_ - begin_ < 32u * KEPT_WORDS;                                          \
    uint kept_ = KEPT_FROM(PARAMS) + (TO_UINT(row_) * KEPT_WORDS + (first_ - begin_) / 32u) * PARAMS.count + (i);
#define PAIR_BITS_(i, at, position) \
    KEPT_AT_(i)                     \
    if (keeps_) {                   \
        bits_ = neighbors[kept_];   \
    } else {                        \
        FIND_PAIRS_(at, position)   \
    }
#define ALL_PAIR_BITS_(i, at, position)                           \
    KEPT_AT_(i)                                                   \
    if (keeps_ && (IMAGE != 0 || PARAMS.iteration > 0u)) {        \
        bits_ = neighbors[kept_];                                 \
    } else {                                                      \
        FIND_PAIRS_(at, position)                                 \
        if (keeps_) neighbors[kept_] = bits_;                     \
    }
#endif
#define PAIRS_(i, home, j, bits)                              \
    ROWS_(home)                                               \
    for (uint first_ = begin_; first_ < end_; first_ += 32u) { \
        uint many_ = min(end_ - first_, 32u);                 \
        uint bits_ = 0u;                                      \
        bits                                                  \
        for (; bits_ != 0u; bits_ &= bits_ - 1u) {            \
            uint j = first_ + LOWEST_BIT(bits_);
#define FOR_PAIRS(i, home, at, position, j) PAIRS_(i, home, j, PAIR_BITS_(i, at, position))
#define FOR_ALL_PAIRS(i, home, at, position, j) PAIRS_(i, home, j, ALL_PAIR_BITS_(i, at, position))
#define END_PAIRS \
    }             \
    END_NEIGHBORS
#define END_ALL_PAIRS(i) END_PAIRS
#endif
