// Depth images of work boxes (thesis 4.1), for kernels and the host: the first voxel in which a line through voxel centres crosses a
// triangle. Scan lines in double; each value depends on one edge only, whichever triangle uses it, so that along any line
// a closed mesh is crossed an even number of times and no line passes between two triangles.
#if defined(__cplusplus)
#pragma once
#include "shaders/common/lang.h"
namespace rivulet {
#elif defined(__OPENCL_C_VERSION__)
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#pragma OPENCL FP_CONTRACT OFF
#endif

// Some rows of one triangle, seen along `axis`. u and v are the axes across, the smaller first; rows are of v. Corners in order of v,
// then u: low, middle, high. Units: voxels.
STRUCT(DepthJob) {
    double lowU, lowV, middleU, middleV;
    double slopeLow, slopeHigh, slopeLong;  // du / dv from low to middle, middle to high, low to high
    double depth, depthU, depthV;           // at the low corner, and its change with u and v
    int axis;
    int firstRow, endRow;   // of this job
    int middleRow;          // from here on the edge from middle to high
    int nearest, furthest;  // voxels along the axis that the triangle spans
};

// A work box: the voxels low..high, none if high < low in x.
STRUCT(DepthBox) {
    int lowX, lowY, lowZ, highX, highY, highZ;
    uint image;  // of its first pixel. Pixels along x (y fastest), then along y (x fastest), then along z (x fastest); two words each
    uint unused;
};

// Slabs of equal thickness along one axis; boxes[k] lies in slab firstSlab + k.
STRUCT(DepthParams) {
    int sizeX, sizeY, sizeZ;  // of the grid
    int slabAxis;
    int thickness, firstSlab, slabs;
    uint jobs;
};

FN int axisU(int axis) { return axis == 0 ? 1 : 0; }
FN int axisV(int axis) { return axis == 2 ? 1 : 2; }
FN int pick(int axis, int x, int y, int z) { return axis == 0 ? x : axis == 1 ? y : z; }

FN int floorOf(double a) {
    int towardsZero = TO_INT(a);
    return TO_DOUBLE(towardsZero) > a ? towardsZero - 1 : towardsZero;
}

// The first row (or column) whose middle is at `a` or beyond; and the first whose middle is beyond `a`.
FN int firstAtOrAfter(double a) { return -floorOf(0.5 - a); }
FN int firstAfter(double a) { return floorOf(a + 0.5); }

FN double depthEdge(double u, double v, double slope, double y) {
    EXACT double along = (y - v) * slope;
    EXACT double at = u + along;
    return at;
}

// The points where row `row` enters and leaves the triangle: columns firstAfter(smaller) .. firstAfter(larger) - 1 are covered.
FN double longEdge(DepthJob job, int row) { return depthEdge(job.lowU, job.lowV, job.slopeLong, TO_DOUBLE(row) + 0.5); }
FN double shortEdge(DepthJob job, int row) {
    double y = TO_DOUBLE(row) + 0.5;
    return row < job.middleRow ? depthEdge(job.lowU, job.lowV, job.slopeLow, y) : depthEdge(job.middleU, job.middleV, job.slopeHigh, y);
}

// The voxel along the axis. The plane of a nearly edge-on triangle gives arbitrary values; hence the limits.
FN int depthAt(DepthJob job, int column, int row) {
    EXACT double across = (TO_DOUBLE(column) + 0.5 - job.lowU) * job.depthU;
    EXACT double up = (TO_DOUBLE(row) + 0.5 - job.lowV) * job.depthV;
    EXACT double slope = across + up;
    EXACT double at = job.depth + slope;
    if (!(at >= TO_DOUBLE(job.nearest))) return job.nearest;
    if (at >= TO_DOUBLE(job.furthest)) return job.furthest;
    return floorOf(at);
}

FN bool boxHolds(DepthBox box, int x, int y, int z) {
    return x >= box.lowX && x <= box.highX && y >= box.lowY && y <= box.highY && z >= box.lowZ && z <= box.highZ;
}

// The first of a pixel's two words: voxels before the first hit from the low face; the second counts from the high face.
FN uint pixelOf(DepthBox box, int axis, int x, int y, int z) {
    uint ex = TO_UINT(box.highX - box.lowX + 1), ey = TO_UINT(box.highY - box.lowY + 1), ez = TO_UINT(box.highZ - box.lowZ + 1);
    uint i = TO_UINT(x - box.lowX), j = TO_UINT(y - box.lowY), k = TO_UINT(z - box.lowZ);
    uint pixel = axis == 0 ? k * ey + j : axis == 1 ? ey * ez + k * ex + i : ey * ez + ex * ez + j * ex + i;
    return 2u * (box.image + pixel);
}
#if defined(__cplusplus)
}  // namespace rivulet
#include "shaders/common/lang_end.h"
#endif
