// The motion of a solid's field during one step. Layout shared by C++, GLSL (std140) and OpenCL: scalars and vec4 only, size % 16
// == 0. A point x of the world is (dot(row.xyz, x) + row.w) in the field's frame; rows are orthonormal: rotation and translation
// without scale.
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
#pragma once
#include "shaders/voxel/field_params.h"
#include "shaders/common/lang.h"
namespace rivulet {
#endif
STRUCT(MotionParams) {
    FieldParams field;
    vec4 startX;  // rows, world -> frame, at the step's start
    vec4 startY;
    vec4 startZ;
    vec4 endX;  // at its end
    vec4 endY;
    vec4 endZ;
    vec4 velocity;    // m/s, of the frame's origin
    vec4 spin;        // rad/s, world axes; w unused
    vec4 origin;      // m, world: the frame's origin at the step's end
    float carried;    // deforming: share of the last displacement that happens in this step, 0 or 1
    float perSecond;  // 1/s, deforming: displacement times this is the wall's velocity
    float unused2;
    float unused3;
};
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
static_assert(sizeof(MotionParams) % 16 == 0);
}  // namespace rivulet
#include "shaders/common/lang_end.h"
#endif
