// The smoothing kernels' factors: what shaders/fluid/methods/shape.h leaves out.
#pragma once

#include "fluid/sim/world/fluid_params.h"
#include "shaders/fluid/world/step_params.h"

namespace rivulet {

// Sum of Wendland C2 over a cubic lattice, times spacing^3: 1 for an infinitely fine one. Densities are divided by it, so that a lattice
// at the given spacing is at rest density exactly. `h / spacing` between 1 and 8.
double wendlandLatticeSum(double supportSpacings);
double cubicLatticeSum(double supportSpacings);  // the same of the cubic spline

// How far neighbours act together: the largest eigenvalue, on a cubic lattice, of the matrix that a Jacobi iteration for the pressures has
// (Wendland C2, diagonal 1). 2.6 at a support of 2 spacings, 6.3 at 3: iterations that converge at one diverge at the other.
double wendlandCoupling(double supportSpacings);

// Fills kernelK and gradientK (h is there) for fluid.kernel: "wendland" or "cubic_spline".
void fillSmoothing(const FluidParams& params, StepParams& step);

}  // namespace rivulet
