// Normals of the fluid's surface, as several forces need them: by a gradient of the density, or by the thesis's sum (7).
#pragma once

#include "fluid/sim/world/step_context.h"

namespace rivulet {

// The sum for the normal of a particle in the flat top layer of a lattice: with COULOMB (unit spacing^-2, the kernel without its factor),
// or of (h - r)^3 r (unit spacing^4). `support`: in spacings.
double flatNormal(double support, bool coulomb);

struct SurfaceNormals {
    PairKernel kernel;
    bool coulomb = false;

    // `coulomb`: the thesis's sum; `walled`: walls count as fluid.
    static Result<SurfaceNormals> find(Device& device, const PairTraits& traits, bool coulomb, bool walled);
    void run(StepContext& context, Buffer& into) const;  // vec4 a particle; w: the length
};

}  // namespace rivulet
