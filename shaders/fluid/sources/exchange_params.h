// Transfer of particles between a world and flow on skins or hosts. Layout shared by C++, GLSL (std140, std430) and OpenCL: size % 16 == 0.
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
#pragma once
#include "shaders/fluid/world/step_params.h"
#include "shaders/common/lang.h"
namespace rivulet {
#endif
STRUCT(ExchangeParams) {
    StepParams step;
    vec4 low;  // xyz m: low corner of the box
    vec4 high;
    uint count;    // number of slots to free, or of claims
    uint most;     // capacity of the result, particles
    float faster;  // m/s: selects particles that are faster, or
    float looser;  // that have a smaller density ratio
};
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
static_assert(sizeof(ExchangeParams) % 16 == 0);
}  // namespace rivulet
#include "shaders/common/lang_end.h"
#endif
