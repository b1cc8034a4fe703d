// A probe on the device, and one thread's partial sums of the load that it measures.
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
#pragma once
#include "shaders/common/lang.h"
namespace rivulet {
#endif
CONSTANT(uint, PROBE_THREADS, 1024u);  // rows of a probe
CONSTANT(uint, PROBE_ALL, 0xFFFFFFFFu);
STRUCT(DeviceProbe) {
    vec4 low;    // m, the region's low corner
    vec4 high;   // m
    vec4 about;  // m, the point of the torque
    uint on;     // what it measures: a ProbeOn
    uint index;  // of those; PROBE_ALL: all of them
    uint count;  // number of probes, the same in each
    uint padding;
};
STRUCT(ProbeRow) {
    vec4 impulse;  // N s, of the fluid on the wall; w: the part along the wall's normal, positive into the wall
    vec4 angular;  // N m s
};
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
static_assert(sizeof(DeviceProbe) == 64 && sizeof(ProbeRow) == 32);
}  // namespace rivulet
#include "shaders/common/lang_end.h"
#endif
