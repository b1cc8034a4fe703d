// Parameters of the kernels of thesis mode in addition to FlowStep: the flow is in UV, lengths are shares of the map's edge, velocities are
// UV/s, and forces are in newtons. Layout shared by C++, GLSL and OpenCL.
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
#pragma once
#include "shaders/common/lang.h"
namespace rivulet {
#endif
STRUCT(ThesisStep) {
    vec4 pull;   // xyz m/s^2, gravity and the acceleration by wind, in the skin's frame
    uint count;  // number of particle slots
    uint triangles;
    float dt;             // s
    float density;        // kg/m^3
    float contactRadius;  // radius of a drop's foot over the cube root of its volume
    float friction;       // mu of (21)
    float adhesive;       // N, F_adhesive of (20)
    float curvature;      // N kg/UV^3, k of (20)
    float curvatureMost;  // N, upper bound of k / |grad rho|
    uint spare0;
    uint spare1;
    uint spare2;
};
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
static_assert(sizeof(ThesisStep) % 16 == 0);
}  // namespace rivulet
#include "shaders/common/lang_end.h"
#endif
