// Virial pressure (Irving and Kirkwood 1950): the stress that pair forces around a particle transmit, which is what a gauge there measures.
// The pressure stored with a particle is close to it, but higher and noisier.
#pragma once

#include <span>
#include <vector>

#include "fluid/sim/world/fluid_params.h"

namespace rivulet {

// Pa, of each particle: a third of the sum over neighbours of V (p_i + p_j) / 2 r |W'(r)|, with Wendland's kernel as the methods have it,
// and its weights of tension where a pressure is negative. Walls are not neighbours: the value is valid a support radius away from walls
// and surface. `pressures`: FluidWorld::pressures().
std::vector<double> virialPressures(std::span<const vec4> positions, std::span<const float> pressures, const FluidParams& params);

}  // namespace rivulet
