#include "fluid/sim/force_surface.h"

#include <cmath>
#include <memory>

#include "fluid/sim/smoothing.h"

namespace rivulet {

namespace {

constexpr double kPiD = 3.14159265358979323846;
constexpr double kTensionFrom = 0.2;  // as in fluid/cohesion

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

// What a flat surface of a lattice pulls along itself with: of the layers under it, half the sum over pairs of (t_i + t_j) f x^2 / r (unit
// spacing a particle), less what they pull inward with, t and f as in fluid/cohesion.
double flatTension(double support) {
    const int n = static_cast<int>(std::ceil(support));
    const double flat = flatNormal(support, false);
    std::vector<double> t;
    for (int layer = 0; layer <= 2 * n; ++layer) {
        double normal = 0;
        for (int y = layer + 1; y <= n; ++y)  // what is below, and has nothing as far above
            for (int x = -n; x <= n; ++x)
                for (int z = -n; z <= n; ++z) {
                    const double r = std::sqrt(double(x * x + y * y + z * z));
                    if (r < support) normal += y * std::pow(support - r, 3);
                }
        t.push_back(std::clamp(normal / flat, kTensionFrom, 1.0) - kTensionFrom);
    }
    double sum = 0;
    for (int layer = 0; layer <= n; ++layer)
        for (int y = -layer; y <= n; ++y)
            for (int x = -n; x <= n; ++x)
                for (int z = -n; z <= n; ++z) {
                    const double r = std::sqrt(double(x * x + y * y + z * z)), q = r / support;
                    if (r >= support || r == 0) continue;
                    const double both = t[static_cast<size_t>(layer)] + t[static_cast<size_t>(layer + y)];
                    sum += 0.5 * both * q * q * q * (1 - q) * (1 - y * y / (r * r)) * (x * x - y * y) / r;
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
        Result<PairKernel> found = PairKernel::find(device, "fluid/normals", traits, defines);
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
    Result<PairKernel> pull = PairKernel::find(device, "fluid/tension_thesis", setup.traits);
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
    Result<PairKernel> pull = PairKernel::find(device, "fluid/cohesion", setup.traits);
    if (!pull) return pull.error();
    PairKernel onSamples;
    const bool samples = setup.traits.matter && setup.traits.samples > 0;
    if (samples) {
        const Define define{"SAMPLES", "1"};
        Result<PairKernel> found = PairKernel::find(device, "fluid/cohesion", setup.traits, std::span(&define, 1));
        if (!found) return found.error();
        onSamples = *found;
    }
    Result<Buffer> buffer = device.allocate(size_t{setup.count} * sizeof(vec4));
    if (!buffer) return buffer.error();
    return ForcePass([normals = *normals, pull = *pull, onSamples, samples,
                      normal = std::make_shared<Buffer>(std::move(*buffer))](StepContext& c) {
        normals.run(c, *normal);
        const ForcesParams& f = c.fluid.forces;
        const double support = double{c.fluid.supportSpacings}, h = support * double{c.fluid.spacing};
        const double unit = 8 / std::pow(support, 3) / (double{c.params.restDensity} * h * h), adhesion = double{f.adhesion} * unit;
        StepParams s = paramsOf(c, vec4(0.0F));
        // The surface of a drop pulls more than a lattice's, with a support of 2.3 spacings by about a quarter. A rough fit to drops of 8
        // to 10 spacings (rivulet validate tension): how they swing then is 10 % off, and their pressures scatter by a third.
        const double more = 1 + 0.8 * (support - 2);
        s.force.x = static_cast<float>(double{f.tension} /
                                       (double{c.params.restDensity} * std::pow(double{c.fluid.spacing}, 2) * flatTension(support) * more));
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
    Result<PairKernel> curl = PairKernel::find(device, "fluid/vorticity", setup.traits);
    if (!curl) return curl.error();
    Result<PairKernel> confine = PairKernel::find(device, "fluid/confinement", setup.traits);
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
    Result<Kernel> air = device.kernel("fluid/air", matter);
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
