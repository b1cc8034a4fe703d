// Liquids: what water, oil or blood are, as rows in SI units, each with its source. In a scene: fluid.liquid, and a block's or emitter's
// own.
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
    vec3 scattering;       // 1/m, reduced: as if it went evenly to all sides
    float refractiveIndex;
    const char* source;
};
Table<LiquidRow> liquids();

// If fluid.liquid is set, restDensity and viscosity come from its row. Error (badInput): an unknown liquid of the world or a block.
Status takeLiquid(FluidParams& params);

// A liquid as particles of a world have it: the row called `name`, or where it is "" the world's own.
struct LiquidOf {
    float density;    // kg/m^3
    float viscosity;  // Pa s
    float row;        // 0: the world's own, else 1 + that in liquids()
    // xyz what it absorbs, w what it scatters beside the world's own, 1/m; w < 0: instead of the world's own, and it scatters -1 - w.
    vec4 absorption;
};
LiquidOf liquidOf(const FluidParams& world, const std::string& name);

// xyz what a dye adds to absorption, 1/m: after 1 / amount metres of it white light has the dye's colour. `colour` linear, 0..1; `amount`
// 1/m.
vec3 dyeAbsorption(const vec3& colour, float amount);
// The same with what it scatters, 1/m, added to what a liquid does to light.
vec4 dyed(const LiquidOf& liquid, const vec3& colour, float amount, float scattering);

}  // namespace rivulet
