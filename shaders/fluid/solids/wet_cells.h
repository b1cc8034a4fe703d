// The wetness at a point of a solid: between the points of its surface. For the host, kernels (after BUFFERS) and shaders of materials.
//   wetCells  int, for each cell of the solid's grid, x fastest, the number of its point of the surface; -1: the surface is not there
//   wetness   float, for each point: 0 dry .. 1 wet
#if !defined(RIVULET_WET_CELLS_H)
#define RIVULET_WET_CELLS_H
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
#include "shaders/common/lang.h"
#define TO_FLOAT(x) static_cast<float>(x)
namespace rivulet {
#endif
// `at`: in cells, from the low corner of the grid. Trilinear between the centres of cells, of those that have a point.
FN float wetAt(GLOBAL(int, wetCells) GLOBAL(float, wetness) vec3 at, int sizeX, int sizeY, int sizeZ, uint firstCell) {
    // From the centre of the cell (-1, -1, -1) on. The comparisons are false for NaN.
    float gx = at.x + 0.5f;
    float gy = at.y + 0.5f;
    float gz = at.z + 0.5f;
    float sum = 0.0f;
    float whole = 0.0f;
    if (gx > 0.0f && gy > 0.0f && gz > 0.0f && gx < TO_FLOAT(sizeX + 1) && gy < TO_FLOAT(sizeY + 1) && gz < TO_FLOAT(sizeZ + 1)) {
        int cx = TO_INT(gx);
        int cy = TO_INT(gy);
        int cz = TO_INT(gz);
        float fx = gx - TO_FLOAT(cx);
        float fy = gy - TO_FLOAT(cy);
        float fz = gz - TO_FLOAT(cz);
        for (int k = 0; k < 8; ++k) {
            int x = cx - 1 + k % 2;
            int y = cy - 1 + k / 2 % 2;
            int z = cz - 1 + k / 4;
            if (x < 0 || y < 0 || z < 0 || x >= sizeX || y >= sizeY || z >= sizeZ) continue;
            int point = wetCells[firstCell + TO_UINT((z * sizeY + y) * sizeX + x)];
            if (point < 0) continue;
            float share = (k % 2 == 0 ? 1.0f - fx : fx) * (k / 2 % 2 == 0 ? 1.0f - fy : fy) * (k / 4 == 0 ? 1.0f - fz : fz);
            sum += share * wetness[point];
            whole += share;
        }
    }
    return whole > 1.0e-6f ? sum / whole : 0.0f;
}
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
}  // namespace rivulet
#undef TO_FLOAT
#include "shaders/common/lang_end.h"
#endif
#endif
