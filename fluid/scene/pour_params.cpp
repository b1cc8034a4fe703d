#include "fluid/scene/pour_params.h"

#include <algorithm>
#include <cmath>

#include "fluid/sim/sources/liquids.h"

namespace rivulet {

namespace {

constexpr float kAbove = 3;  // radii, above the point it falls on

}  // namespace

void PourParams::visit(ParamVisitor& v) {
    v.value({"litres", "l", "volume that a person can pour in (key P); memory is reserved for it; 0 = none", 0, 1.0e6, kLog, kFixed},
            litres);
    v.value({"radius", "m", "radius of the jet; 0 = three spacings", 0, 100, kLog}, radius);
    v.value({"speed", "m/s", "speed of the jet at its start; 0 = that of a fall of three radii", 0, 100}, speed);
    visitLiquid(v, "liquid of the jet; empty = that of fluid.liquid", liquid);
    visitDye(v, dye, dyeAmount, dyeScattering);
}

EmitterParams pouring(const PourParams& pour, const FluidParams& fluid, const std::optional<vec3>& onto) {
    EmitterParams e;
    const float g = glm::length(fluid.gravity);
    e.radius = std::clamp(pour.radius > 0 ? pour.radius : 3 * fluid.spacing, 1.0e-4F, 100.0F);
    e.speed = pour.speed > 0 ? pour.speed : g > 0 ? std::sqrt(2 * g * kAbove * e.radius) : 1.0F;
    e.direction = g > 0 ? fluid.gravity / g : vec3(0, -1, 0);
    e.litresPerSecond = 0;
    e.liquid = pour.liquid;
    e.dye = pour.dye;
    e.dyeAmount = pour.dyeAmount;
    e.dyeScattering = pour.dyeScattering;
    if (!onto) return e;
    e.litresPerSecond = 1000 * kPi * e.radius * e.radius * e.speed;
    const vec3 margin = glm::min(vec3(e.radius + fluid.spacing), 0.5F * (fluid.box.max - fluid.box.min));
    e.position = glm::clamp(*onto - kAbove * e.radius * e.direction, fluid.box.min + margin, fluid.box.max - margin);
    return e;
}

float litresToPour(const FluidParams& fluid, uint32_t particles) {
    const vec3 size = fluid.box.max - fluid.box.min;
    const double volume = std::pow(double{fluid.spacing}, 3), box = double{size.x} * double{size.y} * double{size.z};
    const double wanted = std::min(std::clamp(static_cast<double>(particles), 4000.0, 40000.0) * volume, 0.5 * box);
    const double digit = std::pow(10, std::floor(std::log10(1000 * wanted)) - 1);  // two digits, for display
    return static_cast<float>(std::max(std::round(1000 * wanted / digit), 1.0) * digit);
}

}  // namespace rivulet
