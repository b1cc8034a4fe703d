// A value that a host gives to particles. Layout shared by C++, GLSL (std140, std430) and OpenCL: size % 16 == 0.
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
#pragma once
#include "shaders/common/lang.h"
#include "shaders/fluid/sources/emit_params.h"
namespace rivulet {
#endif
STRUCT(AttributeWrite) {
    SinkVolume inside;  // particles whose value is set
    vec4 value;
    uint count;  // of particles
    uint unused0;
    uint unused1;
    uint unused2;
};
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
static_assert(sizeof(AttributeWrite) % 16 == 0);
}  // namespace rivulet
#include "shaders/common/lang_end.h"
#endif
