// The layout of triangles and work items that the kernels of crossings share with the host. See shaders/voxel/crossing.h.
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
#pragma once
#include "shaders/common/lang.h"
namespace rivulet {
#endif
#if defined(__OPENCL_C_VERSION__)
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#pragma OPENCL FP_CONTRACT OFF
#endif
// A triangle on the device, in doubles: corner 0 x y z, corner 1, corner 2, then 1 / (z1 - z0), 1 / (z2 - z1),
// 1 / (z2 - z0) (0 where they are level), then its plane's dx/dy and dx/dz (0 where it is edge-on).
#define CROSSING_DOUBLES 14u
// A work item: triangle << 1 | (1 if its sorted corners have the orientation of the mesh), its first row, the row after its last.
#define CROSSING_ITEM 3u
// Maximum rows per work item: with rows of 4096 columns, loops stay far below the 65,535 iterations that llvmpipe allows.
#define CROSSING_ROWS 8u
// Bits of a voxel's counter, and the maximum number of crossings per column that they and llvmpipe's loops permit.
#define CROSSING_PLANES 9u
#define CROSSING_DEEPEST 150u

STRUCT(CrossingParams) {
    int sizeX;  // voxels
    int sizeY;
    int sizeZ;
    uint items;
    uint words;  // of 32 bits in the grid
    uint pad0;
    uint pad1;
    uint pad2;
};
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
static_assert(sizeof(CrossingParams) % 16 == 0);
}  // namespace rivulet
#include "shaders/common/lang_end.h"
#endif
