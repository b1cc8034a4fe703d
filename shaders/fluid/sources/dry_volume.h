// A volume that stays dry. Layout shared by C++, GLSL (std140, std430) and OpenCL: scalars and vec4 only, size % 16 == 0.
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
#pragma once
#include "shaders/common/lang.h"
namespace rivulet {
#endif
STRUCT(DryVolume) {
    vec4 centre;  // xyz m; w 0 a box, 1 an ellipsoid
    vec4 reach;   // xyz m, half of the edges or axes; w 1 + the place of the body in whose frame the volume is, 0: in the world
    vec4 turn;    // quaternion x y z w: own frame -> world, or the body's
};
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
static_assert(sizeof(DryVolume) == 48);
}  // namespace rivulet
#include "shaders/common/lang_end.h"
#endif
