// Forces at the fluid's surface: normals, the thesis's tension, a stress along the surface, the air; and vorticity confinement.
#pragma once

#include "fluid/sim/forces/force.h"

namespace rivulet {

bool normalsOn(const FluidParams& params, bool doesViscosity);
Result<ForcePass> makeNormals(Device& device, const MethodSetup& setup);
bool thesisTensionOn(const FluidParams& params, bool doesViscosity);
Result<ForcePass> makeThesisTension(Device& device, const MethodSetup& setup);
bool cohesionOn(const FluidParams& params, bool doesViscosity);
Result<ForcePass> makeCohesion(Device& device, const MethodSetup& setup);
bool vorticityOn(const FluidParams& params, bool doesViscosity);
Result<ForcePass> makeVorticity(Device& device, const MethodSetup& setup);
bool airOn(const FluidParams& params, bool doesViscosity);
Result<ForcePass> makeAir(Device& device, const MethodSetup& setup);

}  // namespace rivulet
