// Forces beside pressure and gravity: rows, each with its own passes, run only where the scene asks for it.
#pragma once

#include <functional>

#include "engine/core/table.h"
#include "fluid/sim/method.h"

namespace rivulet {

// Adds to particles.acceleration (m/s^2) of the fluid and of the samples on bodies. What it owns lives in the closure; of earlier steps it
// remembers nothing that its sums depend on: a saved state would lack it.
using ForcePass = std::function<void(StepContext&)>;

struct ForceRow {
    const char* name;
    const char* doc;
    // Whether these Params ask for it; `doesViscosity`: the method has explicit viscosity among its own pair forces. Asked before every
    // frame; a pass is made the first time it is on.
    bool (*on)(const FluidParams& params, bool doesViscosity);
    Result<ForcePass> (*make)(Device& device, const MethodSetup& setup);
};
Table<ForceRow> forces();

// The longest step (s) with which explicit viscosity is stable: 0.125 hs^2 / nu (Morris et al. 1997).
double explicitViscousLimit(const FluidParams& params);
// The viscosity (m^2/s) whose explicit limit a step must keep; 0 where it is solved for implicitly, or left out. `doesViscosity`: see
// above.
double explicitViscosity(const FluidParams& params, bool doesViscosity);
// The longest step (s) with which surface tension is stable: 0.25 sqrt(rho hs^3 / (2 pi sigma)) (Brackbill et al. 1992).
double capillaryLimit(const FluidParams& params);

}  // namespace rivulet
