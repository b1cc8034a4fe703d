#include "fluid/sim/forces/force_surface.h"

#include <cmath>
#include <memory>

#include "fluid/sim/methods/smoothing.h"

namespace rivulet {

namespace {

constexpr double kPiD = 3.14159265358979323846;
constexpr double kTensionFrom = 0.2;  // as in fluid/forces/cohesion

// Wendland's factors, whatever kernel the method has, and the constants of the row's kernels.
StepParams paramsOf(const StepContext& c, vec4 force) {
    FluidParams wendland = c.fluid;
    wendland.kernel = "wendland";
    StepParams s = c.params;
    fillSmoothing(wendland, s);
    s.force = force;
    return s;
}

// What a particle in the flat top layer of a lattice sums up for its normal: with COULOMB (unit spacing^-2, the kernel without its factor),
// or of (h - r)^3 r (unit spacing^4).
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

// What a flat surface pulls along itself with, per length (unit spacing), of particles strewn evenly under it, one a cubic spacing: the
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

// Normals of either kind into a buffer.
struct Normals {
    PairKernel kernel;
    bool coulomb = false;

    static Result<Normals> find(Device& device, const PairTraits& traits, bool coulomb, bool walled) {
        std::vector<Define> defines;
        if (coulomb) defines.push_back({"COULOMB", "1"});
        if (walled) defines.push_back({"WALLED", "1"});
        Result<PairKernel> found = PairKernel::find(device, "fluid/forces/normals", traits, defines);
        if (!found) return found.error();
        return Normals{*found, coulomb};
    }
    void run(StepContext& c, Buffer& into) const {
        const double flat = flatNormal(double{c.fluid.supportSpacings}, coulomb), spacing = double{c.fluid.spacing};
        // Of the gradient: force.x slope d is in units of a flat surface's; so is force.y times a gradient in 1/m.
        StepParams s = paramsOf(c, vec4(0.0F));
        const double slope = flat * std::pow(spacing, 4);
        s.force.x = static_cast<float>(coulomb ? spacing * spacing / flat : -1 / slope);
        s.force.y = static_cast<float>(1 / (slope * std::pow(spacing, 3) * std::abs(double{s.gradientK})));
        Particles& p = c.particles;
        kernel.run(c, s, {&c.grid.neighbors(), &p.position, &p.density, &p.boundary, &into}, c.grid.pairThreads());
    }
};

// Allocates particles.normal where nobody has: it has one vec4 a particle.
bool hasNormals(StepContext& c) {
    if (c.particles.normal) return true;
    Result<Buffer> made = c.device.allocate(size_t{c.particles.count} * sizeof(vec4));
    if (made) c.particles.normal = std::move(*made);
    return static_cast<bool>(made);
}

}  // namespace

bool normalsOn(const FluidParams& p, bool) { return p.forces.normals != "none"; }

Result<ForcePass> makeNormals(Device& device, const MethodSetup& setup) {
    Result<Normals> coulomb = Normals::find(device, setup.traits, true, false);
    if (!coulomb) return coulomb.error();
    Result<Normals> gradient = Normals::find(device, setup.traits, false, true);
    if (!gradient) return gradient.error();
    return ForcePass([coulomb = *coulomb, gradient = *gradient](StepContext& c) {
        if (hasNormals(c)) (c.fluid.forces.normals == "thesis" ? coulomb : gradient).run(c, c.particles.normal);
    });
}

bool thesisTensionOn(const FluidParams& p, bool) { return p.forces.thesisTension != 0; }

Result<ForcePass> makeThesisTension(Device& device, const MethodSetup& setup) {
    Result<Normals> normals = Normals::find(device, setup.traits, true, false);
    if (!normals) return normals.error();
    Result<PairKernel> pull = PairKernel::find(device, "fluid/forces/tension_thesis", setup.traits);
    if (!pull) return pull.error();
    Result<Buffer> buffer = device.allocate(size_t{setup.count} * sizeof(vec4));
    if (!buffer) return buffer.error();
    return ForcePass([normals = *normals, pull = *pull, normal = std::make_shared<Buffer>(std::move(*buffer))](StepContext& c) {
        normals.run(c, *normal);
        StepParams s = paramsOf(c, vec4(0.0F));
        // A share of the volume each: W times spacing^3.
        s.force.x = c.fluid.forces.thesisTension * s.kernelK * c.fluid.spacing * c.fluid.spacing * c.fluid.spacing;
        Particles& p = c.particles;
        pull.run(c, s, {&c.grid.neighbors(), &p.position, &p.density, normal.get(), &p.acceleration}, c.grid.pairThreads());
    });
}

bool cohesionOn(const FluidParams& p, bool) { return p.forces.tension > 0 || p.forces.adhesion > 0; }

Result<ForcePass> makeCohesion(Device& device, const MethodSetup& setup) {
    Result<Normals> normals = Normals::find(device, setup.traits, false, false);
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
    // Particles at a surface stand in layers, and pull more than if they were strewn: calibrated once, on the pressure in a drop of 20 mm,
    // 10 spacings, at a support of 2.3 (rivulet validate tension --quick).
    constexpr double kLayers = 1.87;
    const double flat = kLayers * flatTension(double{setup.params.supportSpacings});
    return ForcePass([normals = *normals, pull = *pull, onSamples, samples, flat,
                      normal = std::make_shared<Buffer>(std::move(*buffer))](StepContext& c) {
        normals.run(c, *normal);
        const ForcesParams& f = c.fluid.forces;
        const double support = double{c.fluid.supportSpacings}, h = support * double{c.fluid.spacing};
        const double unit = 8 / std::pow(support, 3) / (double{c.params.restDensity} * h * h), adhesion = double{f.adhesion} * unit;
        StepParams s = paramsOf(c, vec4(0.0F));
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

bool vorticityOn(const FluidParams& p, bool) { return p.forces.vorticity > 0; }

Result<ForcePass> makeVorticity(Device& device, const MethodSetup& setup) {
    Result<PairKernel> curl = PairKernel::find(device, "fluid/forces/vorticity", setup.traits);
    if (!curl) return curl.error();
    Result<PairKernel> confine = PairKernel::find(device, "fluid/forces/confinement", setup.traits);
    if (!confine) return confine.error();
    Result<Buffer> buffer = device.allocate(size_t{setup.count} * sizeof(vec4));
    if (!buffer) return buffer.error();
    return ForcePass([curl = *curl, confine = *confine, vorticity = std::make_shared<Buffer>(std::move(*buffer))](StepContext& c) {
        StepParams s = paramsOf(c, vec4(0.0F));
        const float volume = c.fluid.spacing * c.fluid.spacing * c.fluid.spacing;
        // grad W is gradientK slope d.
        s.force = vec4(volume * s.gradientK, c.fluid.forces.vorticity, 0.0F, 0.0F);
        Particles& p = c.particles;
        const uint32_t threads = c.grid.pairThreads();
        curl.run(c, s, {&c.grid.neighbors(), &p.position, &p.velocity, vorticity.get()}, threads);
        confine.run(c, s, {&c.grid.neighbors(), &p.position, vorticity.get(), &p.acceleration}, threads);
    });
}

bool airOn(const FluidParams& p, bool) { return p.forces.airDrag > 0; }

Result<ForcePass> makeAir(Device& device, const MethodSetup& setup) {
    std::vector<Define> matter;
    if (setup.traits.matter) matter.push_back({"MATTER", "1"});
    Result<Kernel> air = device.kernel("fluid/forces/air", matter);
    if (!air) return air.error();
    return ForcePass([air = *air, differ = setup.traits.matter](StepContext& c) {
        // 1/2 rho C A |u| u of a sphere with the particle's volume, over its mass.
        constexpr double kAirDensity = 1.2, kShape = 1.2089939655;  // kg/m^3; (pi / 4) (6 / pi)^(2/3)
        StepParams s = paramsOf(c, vec4(0.0F));
        s.force = vec4(c.fluid.forces.wind, static_cast<float>(0.5 * kAirDensity * kShape * double{c.fluid.forces.airDrag} /
                                                               (double{c.params.restDensity} * double{c.fluid.spacing})));
        Particles& p = c.particles;
        std::vector<const Buffer*> buffers = {&c.grid.cellStart(), &p.velocity, &p.density, &p.acceleration};
        if (differ) buffers.push_back(&p.matter);
        c.device.dispatch(air, std::as_bytes(std::span(&s, 1)), buffers, p.count);
    });
}

double capillaryLimit(const FluidParams& p) {
    const double hs = 0.5 * double{p.supportSpacings} * double{p.spacing};
    return p.forces.tension > 0 ? 0.25 * std::sqrt(double{p.restDensity} * hs * hs * hs / (2 * kPiD * double{p.forces.tension})) : 1.0e30;
}

}  // namespace rivulet
