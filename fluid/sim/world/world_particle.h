// A particle of a FluidWorld as others see it.
#pragma once

#include <cstdint>

#include "engine/core/math.h"

namespace rivulet {

struct WorldParticle {
    vec3 position{0.0F}, velocity{0.0F};  // m, m/s
    float fullness = 0;                   // density ratio, as the last step found it
    uint32_t slot = 0;                    // which it is, until the world's next step
};

}  // namespace rivulet
