// One thread's partial sums of fluid/world/stats.kernel.
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
#pragma once
#include "shaders/common/lang.h"
namespace rivulet {
#endif
#define STATS_THREADS 1024u
STRUCT(StatsRow) {
    vec4 centre;        // sums of positions (m) times masses, w = of masses; in particles of the reference liquid
    float compression;  // sum of max(rho / rho0 - 1, 0)
    float worst;        // its maximum
    float speed2Sum;    // m^2/s^2, times masses
    float speed2Max;    // m^2/s^2
    float limited;      // particles whose speed was limited in the last step
    float nans;         // of the lost ones: NaN or infinite
    float lost;         // particles outside the grid or NaN
    float inside;       // particles counted
    float asleep;       // of them
    float padding0;
    float padding1;
    float padding2;
};
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
static_assert(sizeof(StatsRow) == 64);
}  // namespace rivulet
#include "shaders/common/lang_end.h"
#endif
