// The parameters of emission and sinks. Layout shared by C++, GLSL (std140, std430) and OpenCL: scalars and vec4 only, size % 16 ==
// 0.
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
#pragma once
#include "shaders/fluid/world/step_params.h"
#include "shaders/common/lang.h"
namespace rivulet {
#endif
STRUCT(EmitParams) {
    StepParams step;
    uint candidates;  // number of candidates
    uint sinks;
    uint sinkCounters;  // index of the sinks' first counter
    float nearest;      // m, minimum distance of a candidate to all particles
    float weight;       // contribution of a particle to the density ratio at distance 0
    float crowded;      // maximum density ratio at a candidate and its neighbours
    float unused1;
    float unused2;
};
STRUCT(Candidate) {
    vec4 position;    // xyz m; w index of the emitter
    vec4 velocity;    // xyz m/s
    vec4 matter;      // as Particles::matterOf
    vec4 absorption;  // as ParticleView::absorption
};
STRUCT(SinkVolume) {  // of a sink, or of a volume that a host watches
    vec4 low;         // xyz m: a box's low corner, or a sphere's centre; w 0 a box, 1 a sphere
    vec4 high;        // xyz m: a box's high corner; x m: a sphere's radius
};
// Counters of an emitter, behind each other: given; refused where it was too crowded; refused because no slot was free.
CONSTANT(uint, EMITTER_COUNTERS, 3u);
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
static_assert(sizeof(EmitParams) % 16 == 0 && sizeof(Candidate) == 64 && sizeof(SinkVolume) == 32);
}  // namespace rivulet
#include "shaders/common/lang_end.h"
#endif
