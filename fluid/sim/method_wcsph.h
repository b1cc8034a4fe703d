// Weakly compressible SPH: Tait's equation with Wendland C2 (Monaghan 1994; Wendland 1995), and the thesis's form of it
// (Mueller et al. 2003: poly6, spiky, linear equation of state).
#pragma once

#include "fluid/sim/method.h"

namespace rivulet {

Result<std::unique_ptr<Method>> makeWcsph(Device& device);
Result<std::unique_ptr<Method>> makeWcsphThesis(Device& device);

// Sum of Wendland C2 over a cubic lattice, times spacing^3: 1 for an infinitely fine one. Densities are divided by it, so that a lattice
// at the given spacing is at rest density exactly. `h / spacing` between 1 and 8.
double wendlandLatticeSum(double supportSpacings);
// How far (in spacings) to push a wall back in the density so that a lattice half a spacing off it is at rest density exactly.
double wendlandWallOffset(double supportSpacings);

}  // namespace rivulet
