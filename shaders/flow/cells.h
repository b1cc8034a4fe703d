// Cells of space: those of the flow's grid, and coarser ones with one bit that states whether a drop reaches into them. The bits are stored
// in a hash table (Teschner et al. 2003) without collision handling: a bit may be set because of another cell.
#if !defined(RIVULET_CELLS_H)
#define RIVULET_CELLS_H
#define REACHED_WORDS 4096u
#define REACHED_PARTS 10.0f /* bit k of the word behind them: some drop reaches as far as k to k + 1 of these parts of a cell */
#if !defined(__cplusplus) || defined(RIVULET_KERNEL_UNIT)
#include "shaders/fluid/grid/repeats.h"
// The grid's cells from `low` to `high` along one axis: some in a row, and `over` more from the first one on, since cells repeat in space.
STRUCT(CellSpan) {
    int from;
    int end;
    int over;
};
// `first`: number of cells of padding; `cells`: with it.
FN CellSpan cellSpan(float low, float high, float origin, float scale, int first, int cells) {
    int count = cells - 2 * first;
    float g = min(max(floor((low - origin) * scale), -FARTHEST_CELL), FARTHEST_CELL);
    int many = TO_INT(min(max(floor((high - origin) * scale) - g, 0.0f), TO_FLOAT(count - 1)));
    CellSpan s;
    s.from = repeatedCell(TO_INT(g), first, count);
    s.end = min(s.from + many + 1, first + count);
    s.over = s.from + many + 1 - s.end;
    return s;
}
FN int spanCount(CellSpan s) { return s.end - s.from + s.over; }
FN int spanCell(CellSpan s, int k, int first) { return s.from + k < s.end ? s.from + k : first + k - (s.end - s.from); }
FN uint reachedPart(float far, float inverse) { return 1u << min(TO_UINT(REACHED_PARTS * far * inverse), 31u); }
// m: larger than any distance.
FN float reachOf(uint parts, float cell) {
    uint most = 0u;
    for (uint half_ = 16u; half_ > 0u; half_ = half_ / 2u)
        if (parts >> (most + half_) > 0u) most = most + half_;
    return TO_FLOAT(most + 1u) * cell / REACHED_PARTS;
}
FN int coarseCell(float x, float inverse) { return TO_INT(floor(x * inverse)); }
FN uint reachedBit(int x, int y, int z) {
    uint mixed = TO_UINT(x) * 73856093u ^ TO_UINT(y) * 19349663u ^ TO_UINT(z) * 83492791u;
    return (mixed ^ (mixed >> 15u)) % (REACHED_WORDS * 32u);
}
#endif
#endif
