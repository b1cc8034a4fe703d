// The stop criterion of the pressure solvers: used by the host for the cpu (fluid/sim/methods/solver_residual.cpp), and by
// fluid/methods/solver_progress on a GPU.
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
#pragma once
#include <algorithm>
#include "shaders/common/lang.h"
namespace rivulet {
inline
#else
FN
#endif
    // Estimates the residual after the last change of the pressures from the one before it: it is assumed to fall by the same factor as in
    // the previous iteration.
    float
    residualAhead(float found, float before, uint iteration) {
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
    using std::max;
    using std::min;
#endif
    return found * (iteration > 0u && before > 0.0f ? min(max(found / before, 0.3f), 0.95f) : 0.6f);
}
// The tolerance of a step as a share of the tolerance at the largest step distance. `way`: the distance of the fastest particle as a share
// of that distance. The remaining error causes jitter, which must be small against the motion.
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
inline
#else
FN
#endif
    float
    goalAt(float tolerance, float way) {
    return tolerance * (way < 0.05f ? 0.05f : way > 1.0f ? 1.0f : way);
}
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
}  // namespace rivulet
#include "shaders/common/lang_end.h"
#endif
