// The padded grid: the cell of a position. One empty cell on every side, so that the 27 cells around a particle always exist.
// Particles are sorted by cell: first those of the fluid, then body samples in cells of their own, then, from cell totalCells on,
// samples outside the grid (+ 0), lost particles (+ 1: outside, NaN or infinite), free slots (+ 2), and at + 3 the count of all these. With
// fluid.sleep the sleeping particles follow (velocity.w negative), in cells of their own, the first of them at totalCells + 3.
// Behind all these entries of cellStart a GPU keeps which neighbours are within reach: see neighbors.h.
#if !defined(RIVULET_GRID_H)
#define RIVULET_GRID_H
#if defined(REPEATS)
#include "shaders/fluid/grid/repeats.h"
#endif
// The cell of `x` (m), x fastest, or cellCount if x is outside the unpadded cells, NaN or infinite. (The cpu's sort has finer cells; there
// only the test against cellCount is meaningful.) The conditions are true inside, so that NaN, for which every comparison is false,
// counts as outside. REPEATS: the cells repeat in space, and every finite position has one.
FN uint cellOf(vec3 x, StepParams p) {
    float gx = (x.x - p.gridOrigin.x) * p.gridScale.x;
    float gy = (x.y - p.gridOrigin.y) * p.gridScale.y;
    float gz = (x.z - p.gridOrigin.z) * p.gridScale.z;
    uint cell = p.cellCount;
#if defined(REPEATS)
    if (abs(gx) < FARTHEST_CELL && abs(gy) < FARTHEST_CELL && abs(gz) < FARTHEST_CELL) {
        int cx = repeatedCell(TO_INT(floor(gx)), 1, p.cellsX - 2);
        int cy = repeatedCell(TO_INT(floor(gy)), 1, p.cellsY - 2);
        int cz = repeatedCell(TO_INT(floor(gz)), 1, p.cellsZ - 2);
        cell = TO_UINT((cz * p.cellsY + cy) * p.cellsX + cx);
    }
#else
    if (gx >= 1.0f && gx < TO_FLOAT(p.cellsX - 1) && gy >= 1.0f && gy < TO_FLOAT(p.cellsY - 1) && gz >= 1.0f && gz < TO_FLOAT(p.cellsZ - 1))
        cell = TO_UINT((TO_INT(gz) * p.cellsY + TO_INT(gy)) * p.cellsX + TO_INT(gx));
#endif
    return cell;
}
// The cell that a particle is sorted to. A slot is free if w is negative; else w is the density ratio.
FN uint sortedCell(vec4 x, uint id, StepParams p) {
    uint cell = cellOf(x.xyz, p);
    bool inside = cell < p.cellCount;
    if (id >= p.firstSample) return inside ? cell + p.cellCount : p.totalCells;
    if (x.w < 0.0f) return p.totalCells + 2u;
    return inside ? cell : p.totalCells + 1u;
}
#endif
