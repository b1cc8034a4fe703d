#include "fluid/sim/sources/liquids.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rivulet {

namespace {

// Pope and Fry 1997 at 620, 550 and 450 nm.
constexpr vec3 kPureWater(0.2755F, 0.0565F, 0.00922F);
// Smith and Baker 1981 at the same, of the sea without particles; fresh water's is 1.3 times less.
constexpr vec3 kPureSea(0.0011F, 0.0019F, 0.0045F);
constexpr vec3 kFresh = kPureSea / 1.3F;

constexpr LiquidRow kRows[] = {
    {"water", "fresh water, 20 degC", 998.2F, 1.002e-3F, 0.07275F, kPureWater, kFresh, 1.333F,
     "CRC Handbook of Chemistry and Physics (density, viscosity, index); IAPWS R1-76(2014) (tension); Pope and Fry 1997 (absorption); "
     "Smith and Baker 1981 (scattering)"},
    {"seawater", "35 g of salt per kilogram, 20 degC", 1024.8F, 1.077e-3F, 0.0735F, kPureWater, kPureSea, 1.339F,
     "ITTC 7.5-02-01-03 (density, viscosity); Nayar et al. 2014 (tension); Quan and Fry 1995 (index); absorption as of fresh water, "
     "scattering as of the clearest sea"},
    {"honey", "17 % of water, 20 degC", 1420.0F, 10.0F, 0.06F, vec3(6.0F, 32.0F, 160.0F), vec3(4.0F), 1.494F,
     "White 1975 and Yanniotis et al. 2006 (density, viscosity: 5 to 20 Pa s with its water); Wedmore 1955 (index); tension rounded; "
     "absorption and scattering by eye"},
    {"oil", "olive oil, 20 degC", 911.0F, 0.084F, 0.032F, vec3(3.0F, 6.0F, 60.0F), vec3(0.5F), 1.469F,
     "CRC Handbook of Chemistry and Physics (density, viscosity, tension); Codex Alimentarius CXS 33 (index); absorption and scattering by "
     "eye"},
    {"blood", "whole human blood, 37 degC, at high shear: a Newtonian liquid", 1060.0F, 3.5e-3F, 0.056F, vec3(500.0F, 23000.0F, 33600.0F),
     vec3(1500.0F, 1800.0F, 1900.0F), 1.36F,
     "Kenner 1989 (density); Merrill 1969 (viscosity); Hrncir and Rosina 1997 (tension); Prahl 1998 (absorption: oxygenated, 150 g/l); "
     "Bosschaart et al. 2014 (scattering, rounded)"},
    {"tear", "tears of a healthy eye, 34 degC, at high shear", 1005.0F, 1.73e-3F, 0.0436F, kPureWater, kFresh, 1.337F,
     "Munoz et al. 2024 (viscosity); Tiffany et al. 1989 (tension); Craig et al. 1995 (index); density as of a dilute saline"},
    {"milk", "whole cow's milk, 20 degC", 1030.0F, 2.0e-3F, 0.0465F, vec3(1.1F, 2.4F, 14.0F), vec3(2550.0F, 3210.0F, 3770.0F), 1.347F,
     "Walstra et al. 2006 (density, viscosity, tension, index; rounded); Jensen et al. 2001 (absorption, scattering)"},
};

}  // namespace

Table<LiquidRow> liquids() { return {kRows}; }

Status takeLiquid(FluidParams& params) {
    const auto known = [](const std::string& name, const std::string& where) -> Status {
        if (name.empty() || liquids().find(name) != nullptr) return ok();
        return badInput(fmt::format("{} '{}' is not a liquid; there are {}", where, name, fmt::join(liquids().names(), ", ")));
    };
    if (Status s = known(params.liquid, "fluid.liquid"); !s) return s;
    for (size_t k = 0; k < params.blocks.size(); ++k)
        if (Status s = known(params.blocks[k].liquid, fmt::format("fluid.blocks[{}].liquid", k)); !s) return s;
    if (params.liquid.empty()) return ok();
    const LiquidRow& row = *liquids().find(params.liquid);
    params.restDensity = row.density;
    params.viscosity = row.viscosity / row.density;
    return ok();
}

LiquidOf liquidOf(const FluidParams& world, const std::string& name) {
    const LiquidRow* row = name.empty() || name == world.liquid ? nullptr : liquids().find(name);
    if (row == nullptr) return {world.restDensity, world.viscosity * world.restDensity, 0.0F, vec4(0.0F)};
    return {row->density, row->viscosity, static_cast<float>(row - liquids().rows.data() + 1),
            vec4(row->absorption, -1.0F - row->scattering.y)};
}

vec3 dyeAbsorption(const vec3& colour, float amount) {
    constexpr float kDarkest = 1.0e-3F;  // of a channel: e^-7 is black enough
    vec3 a;
    for (int k = 0; k < 3; ++k) a[k] = -std::log(std::clamp(colour[k], kDarkest, 1.0F)) * amount;
    return a;
}

vec4 dyed(const LiquidOf& liquid, const vec3& colour, float amount, float scattering) {
    const vec4& own = liquid.absorption;
    return {vec3(own) + dyeAbsorption(colour, amount), own.w < 0 ? own.w - scattering : own.w + scattering};
}

void visitLiquid(ParamVisitor& v, const char* doc, std::string& liquid) {
    static const std::vector<std::string> names = liquids().namesOrNone();
    v.choice({.name = "liquid", .doc = doc, .fixed = true}, liquid, names);
}

void visitDye(ParamVisitor& v, vec3& colour, float& amount, float& scattering) {
    constexpr bool kLog = true, kLinear = false, kFixed = true;
    v.colour({"dye", "", "linear colour of the dye in it; white = none", 0, 1, kLinear, kFixed}, colour);
    v.value({"dyeAmount", "1/m", "concentration of the dye: after 1 / this metres light has the dye's colour", 0, 1.0e4, kLog, kFixed},
            amount);
    v.value({"dyeScattering", "1/m", "scattering that the dye adds: milk about 3000; 0 = clear, like ink", 0, 1.0e4, kLog, kFixed},
            scattering);
}

}  // namespace rivulet
