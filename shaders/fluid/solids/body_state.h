// The state of a rigid body, and one thread's partial sums of the fluid's load on it.
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
#pragma once
#include "shaders/common/lang.h"
namespace rivulet {
#endif
CONSTANT(uint, LOAD_THREADS, 64u);  // a body
CONSTANT(float, NOWHERE, 1.0e9f);   // m: where samples of no body are, beyond every grid
STRUCT(DeviceBody) {
    vec4 position;     // m, centre of mass
    vec4 rotation;     // unit quaternion, w last
    vec4 velocity;     // m/s
    vec4 spin;         // rad/s
    uint firstSample;  // index into all samples
    uint endSample;
    uint bodyCount;  // number of bodies
    uint padding;
};
STRUCT(LoadRow) {
    vec4 force;   // N, w: wet share of the surface, summed over samples
    vec4 torque;  // N m, about the centre of mass
};
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
static_assert(sizeof(DeviceBody) == 80 && sizeof(LoadRow) == 32);
}  // namespace rivulet
#include "shaders/common/lang_end.h"
#endif
