// Liquids: the properties of water, oil, blood and others as rows in SI units, each with its source. In a scene: fluid.liquid, and the
// liquid of a block or emitter.
#pragma once

#include "engine/core/result.h"
#include "engine/core/table.h"
#include "fluid/sim/world/fluid_params.h"

namespace rivulet {

struct LiquidRow {
    const char* name;
    const char* doc;
    float density;         // kg/m^3
    float viscosity;       // Pa s, dynamic
    float surfaceTension;  // N/m, against air
    vec3 absorption;       // 1/m, of red, green and blue light (620, 550 and 450 nm)
    vec3 scattering;       // 1/m, reduced: equivalent isotropic scattering
    float refractiveIndex;
    const char* source;
};
Table<LiquidRow> liquids();

// If fluid.liquid is set, restDensity and viscosity come from its row. Error (badInput): an unknown liquid of the world or a block.
Status takeLiquid(FluidParams& params);

// A liquid of particles in a world: the row called `name`, or the world's own if `name` is "".
struct LiquidOf {
    float density;    // kg/m^3
    float viscosity;  // Pa s
    float row;        // 0: the world's own, else 1 + that in liquids()
    // xyz absorption, w scattering, both added to those of the world, 1/m; w < 0: instead of those of the world, with scattering -1 - w.
    vec4 absorption;
};
LiquidOf liquidOf(const FluidParams& world, const std::string& name);

// Returns the absorption that a dye adds, 1/m: after 1 / amount metres white light has the dye's colour. `colour` linear, 0..1; `amount`
// 1/m.
vec3 dyeAbsorption(const vec3& colour, float amount);
// The absorption of `liquid` with a dye in it; `scattering`: what the dye adds, 1/m.
vec4 dyed(const LiquidOf& liquid, const vec3& colour, float amount, float scattering);
// Visits the liquid of a world, a block, an emitter or the poured jet: the key liquid, a row of liquids() or "".
void visitLiquid(ParamVisitor& v, const char* doc, std::string& liquid);
// Visits the dye of a block, an emitter or the poured jet: the keys dye, dyeAmount and dyeScattering.
void visitDye(ParamVisitor& v, vec3& colour, float& amount, float& scattering);

}  // namespace rivulet
