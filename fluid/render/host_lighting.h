// The light of a host's scene, which the water drawn into it shares. Plain data.
#pragma once

#include "engine/core/math.h"
#include "engine/material/image.h"

namespace rivulet {

// The surroundings that water reflects, and refracts where the picture ends: one of the two, linear radiance in the target's units.
struct HostSurroundings {
    const HdrImage* image = nullptr;
    // GL name of a GL_TEXTURE_2D, equirectangular as an HdrImage, or of a GL_TEXTURE_CUBE_MAP, in a format that is read as floats. Level 0
    // is read at the time of the call; call again when it has changed.
    unsigned texture = 0;
    mat3 turn{1.0F};  // a direction in the world of the simulation, +Y up -> the map's: a rotation, which may mirror
};

}  // namespace rivulet
