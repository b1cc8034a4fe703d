// Interpolation between two states. Layout shared by C++, GLSL (std140) and OpenCL: scalars and vec4 only, size % 16 == 0.
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
#pragma once
#include "shaders/common/lang.h"
namespace rivulet {
#endif
STRUCT(BlendParams) {
    float share;   // 0: the earlier state, 1: the newest
    float reach2;  // m^2: a particle with a larger squared displacement is not interpolated
    uint count;
    uint padding0;
};
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
static_assert(sizeof(BlendParams) % 16 == 0);
}  // namespace rivulet
#include "shaders/common/lang_end.h"
#endif
