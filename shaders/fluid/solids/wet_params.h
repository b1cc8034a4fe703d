// The parameters of wet.kernel. Layout shared by C++, GLSL (std140) and OpenCL: scalars and
// vec4 only, size % 16 == 0.
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
#pragma once
#include "shaders/fluid/world/step_params.h"
#include "shaders/common/lang.h"
namespace rivulet {
#endif
STRUCT(WetStep) {
    StepParams step;
    vec4 toWorldX;  // rows, the solid's frame -> world; with `body` unused
    vec4 toWorldY;
    vec4 toWorldZ;
    vec4 down;         // xyz in the solid's frame, with `body` in the world; unit: direction of gravity; 0 without gravity
    vec4 corner;       // xyz m, in the solid's frame: the low corner of its grid of cells
    float cell;        // m, edge
    int sizeX;         // cells
    int sizeY;
    int sizeZ;
    uint firstCell;    // of this solid in the buffer of cells
    uint firstPoint;   // of this solid
    uint points;       // of this solid
    float kept;        // share of the wetness that is left after this frame
    float wetsFully;   // m, a particle at this distance from the surface, or nearer, wets it fully
    float wetsUntil;   // m, beyond this it does not wet it
    float run;         // share of the difference to the surface above that runs down in this frame, on a vertical wall
    float reach;       // m, distance in which the wetness of a run falls to 1/e; 0: nothing runs down
    uint body;         // whose row has the pose, of a body that the device moves; NO_BODY: toWorld has it
    uint unused0;
    uint unused1;
    uint unused2;
};
CONSTANT(uint, NO_BODY, 0xffffffffu);
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
static_assert(sizeof(WetStep) % 16 == 0);
}  // namespace rivulet
#include "shaders/common/lang_end.h"
#endif
