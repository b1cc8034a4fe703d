// The state of a rigid body, what it moves by, and one thread's partial sums of the fluid's load on it.
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
    uint faults;     // BODY_STRAYED, BODY_MISLED: of this frame
    vec4 force;      // N, of the last substep; see BodyLoad
    vec4 torque;     // N m
    vec4 pendingImpulse;         // N s
    vec4 pendingAngularImpulse;  // N m s
    vec4 pushed;                 // N s, of the loads of this frame so far
    vec4 pushedAngular;          // N m s
};
CONSTANT(uint, BODY_STRAYED, 1u);  // its centre of mass left the ball of BodyMotion
CONSTANT(uint, BODY_MISLED, 2u);   // its next state would not have been finite: it keeps the last one
STRUCT(BodyMotion) {
    vec4 inertia;  // kg m^2, about the own axes; w: mass, kg, 0: it never moves
    vec4 ball;     // m: where the centre of mass may be, within w of xyz
    float added;   // mass of the fluid moved along, over the body's
    float samples;  // 0: the water does not meet it
    uint bodyCount;
    uint slot;  // its place in work-group memory of advance_touching, or NO_SLOT: it touches nothing in this frame
    vec4 grip;  // m, own frame: the point that a hand pulls (body_pull.h); w: 1/s, of its spring, 0: none holds it
    vec4 hand;  // m, where to; w: m/s^2, at most
};
CONSTANT(uint, NO_SLOT, 0xffffffffu);
STRUCT(LoadRow) {
    vec4 force;   // N, w: wet share of the surface, summed over samples
    vec4 torque;  // N m, about the centre of mass
};
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
static_assert(sizeof(DeviceBody) == 176 && sizeof(BodyMotion) == 80 && sizeof(LoadRow) == 32);
}  // namespace rivulet
#include "shaders/common/lang_end.h"
#endif
