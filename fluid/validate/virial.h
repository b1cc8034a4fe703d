// Virial pressure (Irving and Kirkwood 1950): what the pair forces about a particle pass on, which is what a gauge there feels. A
// particle's own pressure is what the pairs press with: near it, more than it passes on, and noisier.
#pragma once

#include <span>
#include <vector>

#include "fluid/sim/world/fluid_params.h"

namespace rivulet {

// Pa, of each particle: a third of the sum over neighbours of V (p_i + p_j) / 2 r |W'(r)|, with Wendland's kernel as the methods have it.
// Walls are no neighbours: it holds a support radius away from them and from the surface. `pressures`: FluidWorld::pressures().
std::vector<double> virialPressures(std::span<const vec4> positions, std::span<const float> pressures, const FluidParams& params);

}  // namespace rivulet
