// When a pressure solver may stop: asked by the host on the cpu (fluid/sim/methods/solver_residual.cpp), by fluid/methods/solver_progress
// on a GPU.
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
#pragma once
#include <algorithm>
#include "shaders/common/lang.h"
namespace rivulet {
inline
#else
FN
#endif
    // The residual after what has just been applied, from the one found before it: about as much of it is left as the iteration before
    // left.
    float
    residualAhead(float found, float before, uint iteration) {
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
    using std::max;
    using std::min;
#endif
    return found * (iteration > 0u && before > 0.0f ? min(max(found / before, 0.3f), 0.95f) : 0.6f);
}
// The compression a step may add, of what it may add where the fastest goes as far as it may. `way`: what it goes, of that. What is left
// trembles: it is to be little beside what moves.
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
