#include "fluid/sim/forces/surface_normals.h"

#include <cmath>

#include "fluid/sim/forces/force.h"

namespace rivulet {

double flatNormal(double support, bool coulomb) {
    const int n = static_cast<int>(std::ceil(support));
    double sum = 0;
    for (int y = 1; y <= n; ++y)
        for (int x = -n; x <= n; ++x)
            for (int z = -n; z <= n; ++z) {
                const double r = std::sqrt(double(x * x + y * y + z * z));
                if (r >= support) continue;
                const double a = 1 - r / support;
                sum += coulomb ? y / (r * r * r) * a * a * a * a * (4 * r / support + 1) : y * std::pow(support - r, 3);
            }
    return sum;
}

Result<SurfaceNormals> SurfaceNormals::find(Device& device, const PairTraits& traits, bool coulomb, bool walled) {
    std::vector<Define> defines;
    if (coulomb) defines.push_back({"COULOMB", "1"});
    if (walled) defines = traits.wallDefines({{"WALLED", "1"}});
    Result<PairKernel> found = PairKernel::find(device, "fluid/forces/normals", traits, defines);
    if (!found) return found.error();
    return SurfaceNormals{*found, coulomb};
}

void SurfaceNormals::run(StepContext& c, Buffer& into) const {
    const double flat = flatNormal(double{c.fluid.supportSpacings}, coulomb), spacing = double{c.fluid.spacing};
    // Of the gradient: force.x slope d is in units of a flat surface's.
    StepParams s = forceParams(c, vec4(0.0F));
    const double slope = flat * std::pow(spacing, 4);
    s.force.x = static_cast<float>(coulomb ? spacing * spacing / flat : -1 / slope);
    Particles& p = c.particles;
    kernel.run(c, s, {&c.grid.neighbors(), &p.position, &p.density, &p.nearWalls, &into}, c.grid.pairThreads());
}

}  // namespace rivulet
