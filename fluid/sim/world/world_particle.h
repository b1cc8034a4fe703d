// A particle of a FluidWorld as others see it.
#pragma once

#include <cstdint>

#include "engine/core/math.h"

namespace rivulet {

struct WorldParticle {
    vec3 position{0.0F}, velocity{0.0F};  // m, m/s
    float fullness = 0;                   // density ratio, as the last step found it
    uint32_t slot = 0;                    // which it is, until the world's next step
    uint32_t id = 0;                      // which it is, as long as it exists; then another may have it
};

// A particle to be removed, known from a list that is some frames old.
struct ParticleClaim {
    uint32_t id = 0;
    vec3 position{0.0F};  // m, where it is expected
    float within = 0;     // m, from there: farther away it is another one
};

}  // namespace rivulet
