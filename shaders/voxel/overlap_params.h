// The layout of triangles and work items that the kernel of overlaps shares with the host. See shaders/voxel/overlap.h.
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
#pragma once
#include "shaders/common/lang.h"
namespace rivulet {
#endif
#if defined(__OPENCL_C_VERSION__)
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#pragma OPENCL FP_CONTRACT OFF
#endif
// A triangle's doubles: corner a, then slabs of axis y, axis z, low, high, 1 / axis x (with low and high swapped where that is negative).
#define OVERLAP_SLAB 5u
#define OVERLAP_SLABS 10u
#define OVERLAP_DOUBLES 53u
// A triangle's integers: first and last voxel that its bounds touch, x y z each; then how many of the slabs are level, and how many there
// are.
#define OVERLAP_INTS 8u
// A work item: triangle, first row, the row after its last. Row r of a triangle whose bounds are n voxels wide along y is r % n, r / n.
#define OVERLAP_ITEM 3u
#define OVERLAP_ROWS 32u

STRUCT(OverlapParams) {
    int sizeX;  // voxels
    int sizeY;
    int sizeZ;
    uint items;
};
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
static_assert(sizeof(OverlapParams) % 16 == 0);
}  // namespace rivulet
#include "shaders/common/lang_end.h"
#endif
