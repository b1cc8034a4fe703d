// The parameter block of the kernels that measure a device.
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
#pragma once
#include "shaders/common/lang.h"
namespace rivulet {
#endif
STRUCT(RateParams) {
    uint rounds;  // of the loop
    uint mask;    // of the elements that rate_load reads: their number, a power of two, less 1
    float scale;  // 1: a number that a compiler does not know
    float add;    // 0
};
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
static_assert(sizeof(RateParams) % 16 == 0);
}  // namespace rivulet
#include "shaders/common/lang_end.h"
#endif
