// Triangle-box overlap by separating axes (Akenine-Möller 2001), solved for a row of voxels along x at a time (similar to Schwarz and
// Seidel 2010), in double, identical bit for bit on every device: no division, no fused multiply-add.
//
// A slab is the condition of one axis: a voxel whose centre is q (voxels, from the triangle's corner a) may overlap iff
// low <= axis . q <= high. The host computes the slabs; a level one has no x, a sloped one bounds the row at both ends.
//
// Include after BUFFERS; the buffers are `numbers` and `bounds`.
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
#pragma once
#include "shaders/voxel/overlap_params.h"
#include "shaders/common/lang.h"
namespace rivulet {
#endif
// Voxels first <= x <= last of a row.
STRUCT(OverlapRun) {
    int first;
    int last;
};

FN OverlapRun overlapRow(GLOBAL(double, numbers) GLOBAL(int, bounds) uint triangle, int y, int z) {
    uint at = triangle * OVERLAP_DOUBLES;
    uint box = triangle * OVERLAP_INTS;
    double ax = numbers[at];
    EXACT double qy = TO_DOUBLE(y) + 0.5 - numbers[at + 1u];
    EXACT double qz = TO_DOUBLE(z) + 0.5 - numbers[at + 2u];
    // One more voxel at both ends, so that rounding does not cut off the outermost; the integer bounds limit the run.
    EXACT double from = TO_DOUBLE(bounds[box]) - 0.5 - ax;
    EXACT double to = TO_DOUBLE(bounds[box + 3u]) + 1.5 - ax;
    OverlapRun none;
    none.first = 0;
    none.last = -1;
    int level = bounds[box + 6u];
    int slabs = bounds[box + 7u];
    uint slab = at + 3u;
    for (int k = 0; k < level; ++k) {
        EXACT double way = numbers[slab] * qy + numbers[slab + 1u] * qz;
        if (way < numbers[slab + 2u] || way > numbers[slab + 3u]) return none;
        slab += OVERLAP_SLAB;
    }
    for (int k = level; k < slabs; ++k) {
        EXACT double way = numbers[slab] * qy + numbers[slab + 1u] * qz;
        EXACT double enters = (numbers[slab + 2u] - way) * numbers[slab + 4u];
        EXACT double leaves = (numbers[slab + 3u] - way) * numbers[slab + 4u];
        from = enters > from ? enters : from;
        to = leaves < to ? leaves : to;
        slab += OVERLAP_SLAB;
    }
    if (from > to) return none;
    EXACT double start = from + ax - 0.5;
    EXACT double end = to + ax - 0.5;
    OverlapRun run;
    run.first = TO_INT(start);
    if (TO_DOUBLE(run.first) < start) run.first += 1;
    run.last = TO_INT(end);
    if (TO_DOUBLE(run.last) > end) run.last -= 1;
    run.first = run.first > bounds[box] ? run.first : bounds[box];
    run.last = run.last < bounds[box + 3u] ? run.last : bounds[box + 3u];
    return run;
}

#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
}  // namespace rivulet
#include "shaders/common/lang_end.h"
#endif
