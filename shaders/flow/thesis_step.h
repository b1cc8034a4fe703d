// What the kernels of thesis mode know beside FlowStep: a flow in UV, where a length is a share of the map's edge, a velocity is UV/s, and
// forces stay newtons. Layout shared by C++, GLSL and OpenCL.
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
#pragma once
#include "shaders/common/lang.h"
namespace rivulet {
#endif
STRUCT(ThesisStep) {
    vec4 pull;   // xyz m/s^2, gravity and what the wind does, in the skin's frame
    uint count;  // slots of particles
    uint triangles;
    float dt;             // s
    float density;        // kg/m^3
    float contactRadius;  // of a drop, over the cube root of its volume
    float friction;       // mu of (21)
    float adhesive;       // N, F_adhesive of (20)
    float curvature;      // N kg/UV^3, k of (20)
    float curvatureMost;  // N, what k / |grad rho| is at most
    uint spare0;
    uint spare1;
    uint spare2;
};
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
static_assert(sizeof(ThesisStep) % 16 == 0);
}  // namespace rivulet
#include "shaders/common/lang_end.h"
#endif
