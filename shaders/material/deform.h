// Parameters of deform.kernel and normals.kernel. Layout shared by C++, GLSL and OpenCL.
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
#pragma once
#include "shaders/common/lang.h"
namespace rivulet {
#endif
STRUCT(DeformParams) {
    uint vertices;
    uint bones;  // 0: no skinning
    uint unused0;
    uint unused1;
};
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
static_assert(sizeof(DeformParams) % 16 == 0);
}  // namespace rivulet
#include "shaders/common/lang_end.h"
#endif
