// How a hand pulls a point of a body that it holds (BodyPull of fluid/sim/solids/bodies.h). Read by C++, GLSL and OpenCL.
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
#pragma once
#include <cmath>
#include "shaders/common/lang.h"
namespace rivulet {
#endif
// The spring is explicit: a step must be short beside its time. A point off the centre of mass is `light` times as light as the body: 1 at
// the centre, 4 at the corner of a square seen along its axis, more at a tip.
CONSTANT(float, PULL_SHARE, 0.1f);  // of that time
CONSTANT(float, PULL_LIGHT, 8.0f);  // a lighter point is pulled by a softer spring, which would throw it to and fro otherwise
CONSTANT(float, PULL_CALM, 6.0f);   // 1/s: how fast a body stops turning
// m/s^2, times the mass: a critically damped spring of `rate` (1/s), of at most `most` (m/s^2), that pulls the point at `place` (m), with
// `velocity` (m/s), to `to` (m) in a step of `seconds`. `light`: see above, or an upper bound. A pull carries the body's weight, too, at the centre of mass.
FN vec3 springOf(vec3 place, vec3 velocity, vec3 to, float rate, float most, float seconds, float light) {
    float stiff = PULL_SHARE / seconds < rate ? PULL_SHARE / seconds : rate;
    if (light > PULL_LIGHT) stiff = stiff * (PULL_LIGHT / light);
    vec3 wanted = stiff * stiff * (to - place) - 2.0f * stiff * velocity;
    float size = length(wanted);
    return size > most ? wanted * (most / size) : wanted;
}
// What is left of the spin after such a step: exp(-PULL_CALM seconds). GPUs need not have an exact exponential: the series of an eighth of
// it, correct to rounding for steps of up to 0.1 s.
FN float calmOf(float seconds) {
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
    return std::exp(-PULL_CALM * seconds);
#else
    float x = -0.125f * PULL_CALM * seconds;
    float e = 1.0f + x * (1.0f + x * 0.5f * (1.0f + x * (1.0f / 3.0f) * (1.0f + x * 0.25f)));
    e = e * e;
    e = e * e;
    return e * e;
#endif
}
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
}  // namespace rivulet
#include "shaders/common/lang_end.h"
#endif
