// Forces beside pressure and gravity: rows, each with its own passes, run only where the scene asks for it.
#pragma once

#include <functional>

#include "engine/core/table.h"
#include "fluid/sim/methods/method.h"

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

// A force of the host's own, handed to FluidWorld::create: it runs beside the rows of forces(), before viscosity. Its kernel is a text like
// any other (shaders/common/lang.h): a GPU's device is made with ShaderFiles to which it was added, the cpu's with a CpuKernelRow of the
// same text compiled as C++ (docs in README.md). Params of its own are the host's: no saved state has them.
struct HostForce {
    const char* name = "";  // unlike all others'
    const char* doc = "";
    void* self = nullptr;  // handed to all of these; outlives the world
    // Whether it is on now; none: always. Asked before every frame.
    bool (*on)(void* self, const FluidParams& params) = nullptr;
    // As ForceRow::make. Pass: it adds to particles.acceleration from position and velocity, sorted; StepParams::force is free for it.
    Result<ForcePass> (*make)(void* self, Device& device, const MethodSetup& setup) = nullptr;
    // m/s, the fastest that it drives water; none: no faster than a fall. Beyond ten times what all give speeds are limited, and that is
    // said.
    float (*fastest)(void* self) = nullptr;
    void (*visit)(void* self, ParamVisitor& v) = nullptr;  // its Params; none: it has none
};

// The longest step (s) with which explicit viscosity is stable: 0.125 hs^2 / nu (Morris et al. 1997).
double explicitViscousLimit(const FluidParams& params);
// The viscosity (m^2/s) whose explicit limit a step must keep; 0 where it is solved for implicitly, or left out. `doesViscosity`: see
// above.
double explicitViscosity(const FluidParams& params, bool doesViscosity);
// The longest step (s) with which surface tension is stable: 0.25 sqrt(rho hs^3 / (2 pi sigma)) (Brackbill et al. 1992).
double capillaryLimit(const FluidParams& params);

}  // namespace rivulet
