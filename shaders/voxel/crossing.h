// Signed crossings of triangles with the columns of voxel centres along x, in double, identical bit for bit on every device: no division,
// no fused multiply-add. Coordinates are in voxels from the grid's low corner; a column's centre is at (y + 1/2, z + 1/2).
//
// A triangle's corners are sorted by z. At the height of a row of centres it has two edges, the long one (corner 0 to 2) and a short
// one (0 to 1 or 1 to 2); it covers the columns between them. An edge is always evaluated from its lower end, so that faces that share it
// agree on the columns that it separates, whatever the rounding: a closed mesh has no leak, and no column is counted twice (a half-open
// rule).
//
// Include after BUFFERS; the buffer is `corners`.
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
#pragma once
#include "shaders/voxel/crossing_params.h"
#include "shaders/common/lang.h"
namespace rivulet {
#endif
// The section of a triangle with a row of columns.
STRUCT(CrossingRow) {
    double lowX;  // the cut's bounds along x
    double highX;
    double x;  // the plane at y = 0, z = the row's: x = plane + slope * y
    double slope;
    int first;  // columns first <= y < end
    int end;
    int sense;  // +1: the triangle is entered along +x; -1: left
};

// The number of centres k + 1/2 below x, at most `most`.
FN int centresBelow(double x, int most) {
    EXACT double shifted = x - 0.5;
    EXACT double held = shifted < TO_DOUBLE(most) ? shifted : TO_DOUBLE(most);
    held = held > 0.0 ? held : TO_DOUBLE(0);
    int whole = TO_INT(held);
    return TO_DOUBLE(whole) < held ? whole + 1 : whole;
}

// `sense`: +1 if the sorted corners have the orientation of the mesh, else -1.
FN CrossingRow crossingRow(GLOBAL(double, corners) uint triangle, int sense, int row, int sizeY) {
    uint at = triangle * CROSSING_DOUBLES;
    EXACT double z = TO_DOUBLE(row) + 0.5;
    double z0 = corners[at + 2u];
    double z1 = corners[at + 5u];
    EXACT double along = (z - z0) * corners[at + 11u];
    EXACT double longY = corners[at + 1u] + (corners[at + 7u] - corners[at + 1u]) * along;
    EXACT double longX = corners[at] + (corners[at + 6u] - corners[at]) * along;
    uint upper = z < z1 ? 0u : 1u;
    uint from = at + 3u * upper;
    EXACT double up = (z - corners[from + 2u]) * corners[at + 9u + upper];
    EXACT double shortY = corners[from + 1u] + (corners[from + 4u] - corners[from + 1u]) * up;
    EXACT double shortX = corners[from] + (corners[from + 3u] - corners[from]) * up;
    int longEnd = centresBelow(longY, sizeY);
    int shortEnd = centresBelow(shortY, sizeY);
    CrossingRow r;
    r.lowX = longX < shortX ? longX : shortX;
    r.highX = longX < shortX ? shortX : longX;
    r.slope = corners[at + 12u];
    EXACT double plane = corners[at] + (z - z0) * corners[at + 13u];
    EXACT double origin = plane - corners[at + 1u] * r.slope;
    r.x = origin;
    r.first = longEnd < shortEnd ? longEnd : shortEnd;
    r.end = longEnd < shortEnd ? shortEnd : longEnd;
    r.sense = longEnd < shortEnd ? -sense : sense;
    return r;
}

// The first voxel of column y whose centre lies at or beyond the crossing; sizeX: none does.
FN int crossingVoxel(CrossingRow r, int y, int sizeX) {
    EXACT double centre = TO_DOUBLE(y) + 0.5;
    EXACT double x = r.x + centre * r.slope;
    x = x > r.lowX ? x : r.lowX;
    x = x < r.highX ? x : r.highX;
    return centresBelow(x, sizeX);
}

#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
}  // namespace rivulet
#include "shaders/common/lang_end.h"
#endif
