// One thread's part of fluid/grid/bounds.kernel.
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
#pragma once
#include "shaders/common/lang.h"
namespace rivulet {
#endif
#define BOUNDS_THREADS 256u
STRUCT(BoundsRow) {
    vec4 low;   // xyz m
    vec4 high;  // xyz m, w the number of particles; none: the rest is not valid
};
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
static_assert(sizeof(BoundsRow) == 32);
}  // namespace rivulet
#include "shaders/common/lang_end.h"
#endif
