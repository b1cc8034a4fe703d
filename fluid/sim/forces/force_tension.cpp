#include "fluid/sim/forces/force_tension.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "fluid/sim/forces/force.h"
#include "fluid/sim/forces/surface_normals.h"

namespace rivulet::force_tension {

namespace {

constexpr double kTensionFrom = 0.2;  // as in fluid/forces/cohesion

// What a flat surface pulls along itself with, per length (unit spacing), of particles spread evenly under it, one a cubic spacing: the
// integral over depth z of t(z) times what pairs with what lies deeper and shallower pass on along the surface, less what they pull inward
// with; t and the pull as in fluid/forces/cohesion. A lattice's sum differs by up to a half, as its layers do or do not come within reach.
double flatTension(double support) {
    constexpr int kSlices = 64;  // of a support
    const double slice = support / kSlices, flat = flatNormal(support, false);
    const auto over = [&](double from, const auto& f) {  // from there to the support
        double sum = 0;
        const double step = (support - from) / kSlices;
        for (int k = 0; k < kSlices; ++k) sum += f(from + (k + 0.5) * step);
        return sum * step;
    };
    // Of a plane at a height y: a ring of radius sqrt(r^2 - y^2) at each r.
    const auto pull = [&](double y) {
        return over(y, [&](double r) {
            const double q = r / support, flatter = 1 - y * y / (r * r);
            return kPiD * q * q * q * (1 - q) * flatter * (r * r - 3 * y * y);
        });
    };
    double within = 0;                                                            // of planes up to `depth` above
    for (int k = 0; k < kSlices; ++k) within += slice * pull((k + 0.5) * slice);  // those below
    double sum = 0;
    for (int k = 0; k < kSlices; ++k) {
        const double depth = (k + 0.5) * slice;
        within += slice * pull(depth);
        const double normal = over(depth, [&](double r) { return kPiD * std::pow(support - r, 3) * r * (r * r - depth * depth); }) / flat;
        sum += slice * (std::clamp(normal, kTensionFrom, 1.0) - kTensionFrom) * within;
    }
    return sum;
}

bool on(const FluidParams& p, bool) { return p.forces.tension > 0 || p.forces.adhesion > 0; }

Result<ForcePass> make(Device& device, const MethodSetup& setup) {
    Result<SurfaceNormals> normals = SurfaceNormals::find(device, setup.traits, false, false);
    if (!normals) return normals.error();
    Result<PairKernel> pull = PairKernel::find(device, "fluid/forces/cohesion", setup.traits);
    if (!pull) return pull.error();
    PairKernel onSamples;
    const bool samples = setup.traits.matter && setup.traits.samples > 0;
    if (samples) {
        const Define define{"SAMPLES", "1"};
        Result<PairKernel> found = PairKernel::find(device, "fluid/forces/cohesion", setup.traits, std::span(&define, 1));
        if (!found) return found.error();
        onSamples = *found;
    }
    Result<Buffer> buffer = device.allocate(size_t{setup.count} * sizeof(vec4));
    if (!buffer) return buffer.error();
    // Particles at a surface stand in layers, and pull more than if they were spread evenly: calibrated once, on the pressure in a drop of
    // 20 mm, 10 spacings, at a support of 2.3 (rivulet validate tension --quick).
    constexpr double kLayers = 1.87;
    const double flat = kLayers * flatTension(double{setup.params.supportSpacings});
    return ForcePass([normals = *normals, pull = *pull, onSamples, samples, flat,
                      normal = std::make_shared<Buffer>(std::move(*buffer))](StepContext& c) {
        normals.run(c, *normal);
        const ForcesParams& f = c.fluid.forces;
        const double support = double{c.fluid.supportSpacings}, h = support * double{c.fluid.spacing};
        const double unit = 8 / std::pow(support, 3) / (double{c.params.restDensity} * h * h), adhesion = double{f.adhesion} * unit;
        StepParams s = forceParams(c, vec4(0.0F));
        s.force.x = static_cast<float>(double{f.tension} / (double{c.params.restDensity} * std::pow(double{c.fluid.spacing}, 2) * flat));
        // A(q) at its largest, 0.7, pulls twice as much as cohesion does at its own, 1/64.
        s.force.z = static_cast<float>(1000.0 / 64 / 0.7071 * 2 / 3.9 * adhesion);
        // A plane of samples a spacing apart, each of the volume of a particle: 2 pi h^2 / spacing^2 of them.
        s.force.w = static_cast<float>(double{s.force.z} * 2 * kPiD * support * support);
        Particles& p = c.particles;
        pull.run(c, s, {&c.grid.neighbors(), &p.position, &p.density, normal.get(), &p.acceleration}, c.grid.pairThreads());
        if (samples)
            onSamples.run(c, s, {&c.grid.neighbors(), &p.position, &p.density, normal.get(), &p.acceleration}, c.grid.sampleThreads());
        if (f.adhesion > 0 && c.wallAdhesion) c.wallAdhesion(s);
    });
}

StepLimit limit(const ForceLimitInputs& in) { return {capillaryLimit(in.params), "surface tension"}; }

// In a drop two spacings in radius.
float pressure(const FluidParams& p) { return p.forces.tension / p.spacing; }

float fastest(const FluidParams& p) { return std::sqrt((p.forces.tension + p.forces.adhesion) / (p.restDensity * p.spacing)); }

}  // namespace

void Params::visit(ParamVisitor& v) {
    v.value({"tension", "N/m", "surface tension: 0 = none; water 0.072; substeps become as short as capillary waves need", 0, 100},
            tension);
    v.value({"adhesion", "N/m",
             "attraction of the fluid by walls and bodies, on the scale of tension: about the same value makes fluid stick", 0, 100},
            adhesion);
}

ForceRow row() {
    return {.name = "tension",
            .doc = "surface tension as a stress along the surface, adhesion to walls and bodies (Akinci et al. 2013)",
            .order = 30,
            .remedy = "set fluid.forces.tension and fluid.forces.adhesion to 0",
            .on = on,
            .make = make,
            .limit = limit,
            .fastest = fastest,
            .pressure = pressure,
            .keepsAwake = true};
}

}  // namespace rivulet::force_tension

namespace rivulet {

double capillaryLimit(const FluidParams& p) {
    const double hs = 0.5 * double{p.supportSpacings} * double{p.spacing};
    return p.forces.tension > 0 ? 0.25 * std::sqrt(double{p.restDensity} * hs * hs * hs / (2 * kPiD * double{p.forces.tension})) : 1.0e30;
}

}  // namespace rivulet
