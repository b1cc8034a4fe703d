// Queries of a host about the water. Layout shared by C++, GLSL (std140, std430) and OpenCL: size % 16 == 0.
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
#pragma once
#include "shaders/fluid/world/step_params.h"
#include "shaders/common/lang.h"
namespace rivulet {
#endif
// Flags of a ray: it enters the grid from outside; it leaves the grid.
#define RAY_ENTERS 1u
#define RAY_LEAVES 2u
STRUCT(QueryParams) {
    StepParams step;
    uint count;    // number of points or rays
    float weight;  // contribution of a particle to the density ratio at distance 0
    float level;   // the density ratio on the surface
    float stride;  // m, step along a ray
};
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
static_assert(sizeof(QueryParams) % 16 == 0);
}  // namespace rivulet
#include "shaders/common/lang_end.h"
#endif
