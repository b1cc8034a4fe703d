// Volumes that a host watches; their shapes are SinkVolume of emit_params.h. Layout shared by C++, GLSL (std140, std430) and OpenCL: size %
// 16 == 0.
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
#pragma once
#include "shaders/fluid/world/step_params.h"
#include "shaders/common/lang.h"
namespace rivulet {
#endif
STRUCT(VolumeParams) {
    StepParams step;
    uint count;  // number of volumes
    uint keep;   // bits of the volumes that were watched in the last step
    uint unused0;
    uint unused1;
};
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
static_assert(sizeof(VolumeParams) % 16 == 0);
}  // namespace rivulet
#include "shaders/common/lang_end.h"
#endif
