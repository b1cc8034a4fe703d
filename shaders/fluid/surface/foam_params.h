// The parameters of the foam kernels. Layout shared by C++, GLSL (std140, std430) and OpenCL: scalars and vec4 only, size % 16 == 0.
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
#pragma once
#include "shaders/fluid/world/step_params.h"
#include "shaders/common/lang.h"
namespace rivulet {
#endif
STRUCT(FoamStep) {
    StepParams step;
    vec4 wind;          // xyz m/s; w 1/m: drag rate of spray (1/s) over its speed relative to the wind
    uint slots;         // number of foam slots
    uint seed;          // random seed of this frame
    float seconds;      // s, duration of this frame
    float births;       // share of the wanted foam particles that there is room for
    float life;         // s, maximum lifetime of foam
    float buoyancy;     // upward acceleration of a bubble over gravity
    float drag;         // 1/s, drag rate of a bubble towards the velocity of the water
    float fullness;     // contribution of a particle to the density ratio at distance 0
    float sprayBelow;   // density ratio below which it is spray
    float bubbleAbove;  // density ratio above which it is a bubble
    float unused1;
    float unused2;
};
// A slot of foam: place, vec4: xyz m, w remaining life, s (0: free); velocity, vec4: xyz m/s, w size, 0.5 to 1, plus its kind: 1 spray,
// 2 foam, 3 bubble.
// Lists: [0] alive, [1] free ones listed, [2] spawns requested, [3] spawns made, or refused because no slot was left;
// then the free ones.
CONSTANT(uint, FOAM_LISTS, 4u);
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
static_assert(sizeof(FoamStep) % 16 == 0);
}  // namespace rivulet
#include "shaders/common/lang_end.h"
#endif
