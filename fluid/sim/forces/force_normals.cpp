#include "fluid/sim/forces/force_normals.h"

#include "fluid/sim/forces/force.h"
#include "fluid/sim/forces/surface_normals.h"

namespace rivulet::force_normals {

namespace {

// Allocates particles.normal at the first call: one vec4 a particle.
bool hasNormals(StepContext& c) {
    if (c.particles.normal) return true;
    Result<Buffer> made = c.device.allocate(size_t{c.particles.count} * sizeof(vec4));
    if (made) c.particles.normal = std::move(*made);
    return static_cast<bool>(made);
}

bool on(const FluidParams& p, bool) { return p.forces.normals != "none"; }

Result<ForcePass> make(Device& device, const MethodSetup& setup) {
    Result<SurfaceNormals> coulomb = SurfaceNormals::find(device, setup.traits, true, false);
    if (!coulomb) return coulomb.error();
    Result<SurfaceNormals> gradient = SurfaceNormals::find(device, setup.traits, false, true);
    if (!gradient) return gradient.error();
    return ForcePass([coulomb = *coulomb, gradient = *gradient](StepContext& c) {
        c.particles.hasNormals = hasNormals(c);
        if (c.particles.hasNormals) (c.fluid.forces.normals == "thesis" ? coulomb : gradient).run(c, c.particles.normal);
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
