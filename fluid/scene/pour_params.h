// The jet that a person may pour into a scene. In the world it is one more emitter.
#pragma once

#include <optional>
#include <string>

#include "fluid/sim/sources/emitter.h"
#include "fluid/sim/world/fluid_params.h"

namespace rivulet {

struct PourParams {
    float litres = 0.0F;                            // memory is reserved for this volume; 0: no jet
    float radius = 0.0F;                            // m, of the jet; 0 = three spacings
    float speed = 0.0F;                             // m/s, at its start; 0 = that of a fall of three radii
    std::string liquid;                             // a row of liquids(); "" = the world's
    vec3 dye{1.0F};                                 // linear; white = none
    float dyeAmount = 20.0F, dyeScattering = 0.0F;  // 1/m
    void visit(ParamVisitor& v);
};

// The emitter. `onto`: m, the point that it falls on; it starts 3 radii above, inside the box. Nothing: it is off.
EmitterParams pouring(const PourParams& pour, const FluidParams& fluid, const std::optional<vec3>& onto);
// A useful volume for a scene of `particles`, litres, rounded to two digits.
float litresToPour(const FluidParams& fluid, uint32_t particles);

}  // namespace rivulet
