// Weakly compressible SPH: Tait's equation with Wendland C2 or the cubic spline (Monaghan 1994; Wendland 1995), and the thesis's form of it
// (Mueller et al. 2003: poly6, spiky, linear equation of state).
#pragma once

#include "fluid/sim/methods/method.h"

namespace rivulet {

Result<std::unique_ptr<Method>> makeWcsph(Device& device, const MethodSetup& setup);
Result<std::unique_ptr<Method>> makeWcsphThesis(Device& device, const MethodSetup& setup);

}  // namespace rivulet
