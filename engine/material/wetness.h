// WetGrid: where the wetness of a mesh is in the buffers that a renderer has for all meshes. See shaders/material/wet.glsl.
#pragma once

#include <cstdint>

#include "engine/core/math.h"

namespace rivulet {

struct WetGrid {
    mat4 fromWorld{1.0F};    // world (m) -> cells of the grid, from its low corner
    ivec3 size{0};           // cells
    uint32_t firstCell = 0;  // of the buffer of cells
};

}  // namespace rivulet
