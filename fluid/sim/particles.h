// Every array that belongs to a particle. Between steps the newest state is positionNext, velocityNext, id; a step sorts it into
// position, velocity, id (sorted by cell), computes, and integrates back into positionNext, velocityNext in the sorted order.
#pragma once

#include "engine/compute/device.h"

namespace rivulet {

struct Particles {
    uint32_t count = 0;
    Buffer position, velocity;          // vec4: m, m/s; sorted, at the step's start
    Buffer positionNext, velocityNext;  // vec4; w: density / rest density, 1 where the speed was limited
    Buffer id, idNext;                  // uint; id goes with the newest state
    Buffer density;                     // float, kg/m^3
    Buffer pressure;                    // float, what the method makes of it
    Buffer acceleration;                // vec4, m/s^2
    Buffer boundary;                    // vec4: gradient (1/m) and share of the walls

    static Result<Particles> create(Device& device, uint32_t count);
};

}  // namespace rivulet
