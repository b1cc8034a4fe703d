// The parameters of the pass that keeps volumes dry. Layout shared by C++, GLSL (std140, std430) and OpenCL: size % 16 == 0.
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
#pragma once
#include "shaders/common/lang.h"
#include "shaders/fluid/world/step_params.h"
namespace rivulet {
#endif
STRUCT(DryParamsBlock) {
    StepParams step;
    uint volumes;
    uint unused0;
    uint unused1;
    uint unused2;
};
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
static_assert(sizeof(DryParamsBlock) % 16 == 0);
}  // namespace rivulet
#include "shaders/common/lang_end.h"
#endif
