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

}  // namespace rivulet
