// What deform.kernel and normals.kernel know of a mesh. Layout shared by C++, GLSL and OpenCL.
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
#pragma once
#include "shaders/common/lang.h"
namespace rivulet {
#endif
STRUCT(DeformParams) {
    uint vertices;
    uint bones;  // 0: nothing is turned
    uint unused0;
    uint unused1;
};
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
static_assert(sizeof(DeformParams) % 16 == 0);
}  // namespace rivulet
#include "shaders/common/lang_end.h"
#endif
