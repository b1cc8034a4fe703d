// The jet that the user pours into a scene with the mouse. In the world it is one more emitter.
#pragma once

#include <optional>
#include <string>

#include "fluid/sim/sources/emitter.h"
#include "fluid/sim/world/fluid_params.h"

namespace rivulet {

struct PourParams {
    float litres = 0.0F;                            // memory is reserved for this volume; 0: no jet
    float radius = 0.0F;                            // m, of the jet; 0 = three spacings
    float speed = 0.0F;                             // m/s, at its start; 0 = the speed after a fall of three radii
    std::string liquid;                             // a row of liquids(); "" = the world's
    vec3 dye{1.0F};                                 // linear; white = none
    float dyeAmount = 20.0F, dyeScattering = 0.0F;  // 1/m
    void visit(ParamVisitor& v);
};

// Returns the emitter of the jet. `onto`: target point, m; the jet starts 3 radii above it, inside the box. Empty: the jet is off.
EmitterParams pouring(const PourParams& pour, const FluidParams& fluid, const std::optional<vec3>& onto);
// Returns a useful volume for a scene of `particles`, litres, rounded to two digits.
float litresToPour(const FluidParams& fluid, uint32_t particles);

}  // namespace rivulet
