#include "fluid/sim/forces/force_vorticity.h"

#include <memory>

#include "fluid/sim/forces/force.h"

namespace rivulet::force_vorticity {

namespace {

bool on(const FluidParams& p, bool) { return p.forces.vorticity > 0; }

Result<ForcePass> make(Device& device, const MethodSetup& setup) {
    Result<PairKernel> curl = PairKernel::find(device, "fluid/forces/vorticity", setup.traits);
    if (!curl) return curl.error();
    Result<PairKernel> confine = PairKernel::find(device, "fluid/forces/confinement", setup.traits);
    if (!confine) return confine.error();
    Result<Buffer> buffer = device.allocate(size_t{setup.count} * sizeof(vec4));
    if (!buffer) return buffer.error();
    return ForcePass([curl = *curl, confine = *confine, vorticity = std::make_shared<Buffer>(std::move(*buffer))](StepContext& c) {
        StepParams s = forceParams(c, vec4(0.0F));
        const float volume = c.fluid.spacing * c.fluid.spacing * c.fluid.spacing;
        // grad W is gradientK slope d.
        s.force = vec4(volume * s.gradientK, c.fluid.forces.vorticity, 0.0F, 0.0F);
        Particles& p = c.particles;
        const uint32_t threads = c.grid.pairThreads();
        curl.run(c, s, {&c.grid.neighbors(), &p.position, &p.velocity, vorticity.get()}, threads);
        confine.run(c, s, {&c.grid.neighbors(), &p.position, vorticity.get(), &p.acceleration}, threads);
    });
}

}  // namespace

void Params::visit(ParamVisitor& v) {
    v.value(
        {"vorticity", "1/s", "strength of vorticity confinement (Macklin and Mueller 2013), which preserves vortices; 0 = none", 0, 100},
        vorticity);
}

ForceRow row() {
    return {.name = "vorticity",
            .doc = "vorticity confinement (Macklin and Mueller 2013)",
            .order = 40,
            .remedy = "set fluid.forces.vorticity to 0",
            .on = on,
            .make = make,
            .keepsAwake = true};
}

}  // namespace rivulet::force_vorticity
