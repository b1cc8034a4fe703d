#include "fluid/sim/forces/force_thesis_tension.h"

#include <memory>

#include "fluid/sim/forces/force.h"
#include "fluid/sim/forces/surface_normals.h"

namespace rivulet::force_thesis_tension {

namespace {

bool on(const FluidParams& p, bool) { return p.forces.thesisTension != 0; }

Result<ForcePass> make(Device& device, const MethodSetup& setup) {
    Result<SurfaceNormals> normals = SurfaceNormals::find(device, setup.traits, true, false);
    if (!normals) return normals.error();
    Result<PairKernel> pull = PairKernel::find(device, "fluid/forces/tension_thesis", setup.traits);
    if (!pull) return pull.error();
    Result<Buffer> buffer = device.allocate(size_t{setup.count} * sizeof(vec4));
    if (!buffer) return buffer.error();
    return ForcePass([normals = *normals, pull = *pull, normal = std::make_shared<Buffer>(std::move(*buffer))](StepContext& c) {
        normals.run(c, *normal);
        StepParams s = forceParams(c, vec4(0.0F));
        // A share of the volume each: W times spacing^3.
        s.force.x = c.fluid.forces.thesisTension * s.kernelK * c.fluid.spacing * c.fluid.spacing * c.fluid.spacing;
        Particles& p = c.particles;
        pull.run(c, s, {&c.grid.neighbors(), &p.position, &p.density, normal.get(), &p.acceleration}, c.grid.pairThreads());
    });
}

}  // namespace

void Params::visit(ParamVisitor& v) {
    v.value({"thesisTension", "m/s^2",
             "the thesis's surface tension (8), as the acceleration at a flat surface: < 0 pulls inward, 0 = none", -1000, 1000},
            thesisTension);
}

ForceRow row() {
    return {.name = "thesis_tension",
            .doc = "the thesis's surface tension (8) from its normals (7)",
            .order = 20,
            .remedy = "set fluid.forces.thesisTension to 0",
            .on = on,
            .make = make,
            .keepsAwake = true};
}

}  // namespace rivulet::force_thesis_tension
