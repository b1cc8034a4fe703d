#include "fluid/sim/forces/force_normals.h"

#include <memory>

#include "fluid/sim/forces/force.h"
#include "fluid/sim/forces/surface_normals.h"

namespace rivulet::force_normals {

namespace {

bool on(const FluidParams& p, bool) { return p.forces.normals != "none"; }

Result<ForcePass> make(Device& device, const MethodSetup& setup) {
    Result<SurfaceNormals> coulomb = SurfaceNormals::find(device, setup.traits, true, false);
    if (!coulomb) return coulomb.error();
    Result<SurfaceNormals> gradient = SurfaceNormals::find(device, setup.traits, false, true);
    if (!gradient) return gradient.error();
    Result<Buffer> made = device.allocate(size_t{setup.count} * sizeof(vec4));
    if (!made) return made.error();
    return ForcePass([coulomb = *coulomb, gradient = *gradient, normal = std::make_shared<Buffer>(std::move(*made))](StepContext& c) {
        if (!c.particles.normal) c.particles.normal = std::move(*normal);
        c.particles.hasNormals = true;
        (c.fluid.forces.normals == "thesis" ? coulomb : gradient).run(c, c.particles.normal);
    });
}

}  // namespace

void Params::visit(ParamVisitor& v) {
    static const std::vector<std::string> kinds = {"none", "thesis", "gradient"};
    v.choice({.name = "normals",
              .doc = "surface normals, for display (look.colourBy normal or surface); thesis: its (7), which treats walls as air; "
                     "gradient: from the density, walls counted as fluid"},
             normals, kinds);
}

ForceRow row() {
    return {.name = "normals",
            .doc = "surface normals, for display",
            .order = 10,
            .remedy = "set fluid.forces.normals to none",
            .on = on,
            .make = make,
            .keepsAwake = true};
}

}  // namespace rivulet::force_normals
