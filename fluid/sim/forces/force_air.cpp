#include "fluid/sim/forces/force_air.h"

#include "fluid/sim/forces/force.h"

namespace rivulet::force_air {

namespace {

constexpr double kFast = 1.0e3;  // m/s

bool on(const FluidParams& p, bool) { return p.forces.airDrag > 0; }

Result<ForcePass> make(Device& device, const MethodSetup& setup) {
    std::vector<Define> matter;
    if (setup.traits.matter) matter.push_back({"MATTER", "1"});
    Result<Kernel> air = device.kernel("fluid/forces/air", matter);
    if (!air) return air.error();
    return ForcePass([air = *air, differ = setup.traits.matter](StepContext& c) {
        // 1/2 rho C A |u| u of a sphere with the particle's volume, over its mass.
        constexpr double kAirDensity = 1.2, kShape = 1.2089939655;  // kg/m^3; (pi / 4) (6 / pi)^(2/3)
        StepParams s = forceParams(c, vec4(0.0F));
        s.force = vec4(c.fluid.forces.wind, static_cast<float>(0.5 * kAirDensity * kShape * double{c.fluid.forces.airDrag} /
                                                               (double{c.params.restDensity} * double{c.fluid.spacing})));
        Particles& p = c.particles;
        std::vector<const Buffer*> buffers = {&c.grid.cellStart(), &p.velocity, &p.density, &p.acceleration};
        if (differ) buffers.push_back(&p.matter);
        c.device.dispatch(air, std::as_bytes(std::span(&s, 1)), buffers, c.params.awakeSlots);
    });
}

float fastest(const FluidParams& p) { return p.forces.airDrag > 0 ? glm::length(p.forces.wind) : 0.0F; }

}  // namespace

void Params::visit(ParamVisitor& v) {
    v.value({"airDrag", "", "drag coefficient of drops in air of 1.2 kg/m^3: a sphere 0.47; 0 = no air", 0, 10}, airDrag);
    v.value({"wind", "m/s", "velocity of the air; no effect if airDrag is 0", -kFast, kFast}, wind);
}

ForceRow row() {
    return {.name = "air",
            .doc = "air drag and wind on particles that are exposed to air (Gissler et al. 2017, simplified)",
            .order = 50,
            .remedy = "set fluid.forces.airDrag to 0",
            .on = on,
            .make = make,
            .fastest = fastest};
}

}  // namespace rivulet::force_air
