// What foam's kernels know. Layout shared by C++, GLSL (std140, std430) and OpenCL: scalars and vec4 only, size % 16 == 0.
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
#pragma once
#include "shaders/fluid/world/step_params.h"
#include "shaders/common/lang.h"
namespace rivulet {
#endif
STRUCT(FoamStep) {
    StepParams step;
    vec4 wind;          // m/s; w 1/m: how soon it carries spray along, 1/s, over the spray's speed in it
    uint slots;         // of foam
    uint seed;          // of this frame
    float seconds;      // of this frame
    float births;       // share of what would be born that there is room for
    float life;         // s, the longest that foam lies on water
    float buoyancy;     // of a bubble, over gravity
    float drag;         // 1/s, how soon a bubble goes with the water
    float fullness;     // a particle's share of the density ratio at distance 0
    float sprayBelow;   // density ratio up to which it flies
    float bubbleAbove;  // and from which on it is under water
    float unused1;
    float unused2;
};
// A slot of foam: place, vec4: xyz m, w the rest of its life, s (0: free); velocity, vec4: xyz m/s, w its size, 0.5 to 1, and what it is in
// whole numbers: 1 spray, 2 foam, 3 a bubble.
// Lists: [0] alive, [1] free ones listed, [2] that would be born, [3] that were, or for which chance left no
// slot; then the free ones.
CONSTANT(uint, FOAM_LISTS, 4u);
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
static_assert(sizeof(FoamStep) % 16 == 0);
}  // namespace rivulet
#include "shaders/common/lang_end.h"
#endif
