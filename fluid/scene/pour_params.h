// What a person's hand may pour into a scene: how much there is room for, of what, and how it falls. To the world it is one more emitter.
#pragma once

#include <optional>
#include <string>

#include "fluid/sim/sources/emitter.h"
#include "fluid/sim/world/fluid_params.h"

namespace rivulet {

struct PourParams {
    float litres = 0.0F;                            // room is kept for so much; 0: none
    float radius = 0.0F;                            // m, of the jet; 0 = three spacings
    float speed = 0.0F;                             // m/s, where it begins; 0 = as if it had fallen three radii
    std::string liquid;                             // a row of liquids(); "" = the world's
    vec3 dye{1.0F};                                 // linear; white = none
    float dyeAmount = 20.0F, dyeScattering = 0.0F;  // 1/m
    void visit(ParamVisitor& v);
};

// The emitter. `onto`: the place it falls on, m, from a little above, but from within the box; nothing: it lets nothing out.
EmitterParams pouring(const PourParams& pour, const FluidParams& fluid, const std::optional<vec3>& onto);
// Litres that are worth pouring into a box of `particles`.
float litresToPour(const FluidParams& fluid, uint32_t particles);

}  // namespace rivulet
