// HostParticles: a world's particles, read back from its Device.
#pragma once

#include <cstdint>
#include <vector>

#include "fluid/sim/world/fluid_world.h"

namespace rivulet {

struct HostParticles {
    std::vector<vec4> position, velocity;  // as in ParticleView, without free slots
    std::vector<uint32_t> id;
    std::vector<float> mass;                    // kg
    std::vector<std::vector<vec4>> attributes;  // of FluidParams::attributes
    std::vector<float> pressure;                // Pa, as FluidWorld::pressures(); empty if not requested
};
HostParticles readParticles(const FluidWorld& world, bool pressures = false);

}  // namespace rivulet
