// The parameter block of the kernels of fluid/sim/sleep.
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
#pragma once
#include "shaders/common/lang.h"
#include "shaders/fluid/world/step_params.h"
namespace rivulet {
#endif
STRUCT(SleepStep) {
    StepParams step;
    vec4 wakeMin;     // m, of a box in which cells are disturbed
    vec4 wakeMax;     // m
    float now;        // s, time at the end of the step
    float calmFor;    // s, for which a cell and its neighbours must be calm before its particles fall asleep
    float together2;  // m^2, square of the rms way of a cell's particles since they were last noted that counts as a disturbance
    float alone2;     // m^2, the same of one particle alone
    float pressure2;  // m^4/s^4, square of the rms deviation of a cell's pressures from their mean that counts as a disturbance
    float share;      // of the present value in the mean of a pressure
    float scale;      // from the method's pressures to m^2/s^2; sleep_recall: back
    uint mayRest;     // 1: cells may fall asleep in this step; else they can only wake
    uint cells;       // of the grid, one along x for two of the cpu's
    float padding0;
    float padding1;
    float padding2;
};
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
static_assert(sizeof(SleepStep) % 16 == 0);
}  // namespace rivulet
#include "shaders/common/lang_end.h"
#endif
