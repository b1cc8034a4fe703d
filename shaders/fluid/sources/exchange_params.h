// What passes between a world and others who hold water. Layout shared by C++, GLSL (std140, std430) and OpenCL: size % 16 == 0.
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
#pragma once
#include "shaders/fluid/world/step_params.h"
#include "shaders/common/lang.h"
namespace rivulet {
#endif
STRUCT(ExchangeParams) {
    StepParams step;
    vec4 low;  // xyz m: the box that is asked about
    vec4 high;
    uint count;    // of slots taken
    uint most;     // how many particles fit into the answer
    float faster;  // m/s: only what is, or
    float looser;  // has less than this density ratio
};
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
static_assert(sizeof(ExchangeParams) % 16 == 0);
}  // namespace rivulet
#include "shaders/common/lang_end.h"
#endif
