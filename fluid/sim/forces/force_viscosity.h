// Viscosity of methods that have none of their own, explicit or implicit, and what no-slip walls do in every method.
#pragma once

#include "fluid/sim/forces/force.h"

namespace rivulet {

bool viscosityOn(const FluidParams& params, bool doesViscosity);
Result<ForcePass> makeViscosity(Device& device, const MethodSetup& setup);

}  // namespace rivulet
