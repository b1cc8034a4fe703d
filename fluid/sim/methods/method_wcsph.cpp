// Weakly compressible SPH (Monaghan 1994; Mueller et al. 2003).
#include "fluid/sim/methods/method_wcsph.h"

#include <cmath>

#include "engine/core/assert.h"
#include "fluid/sim/methods/method.h"
#include "fluid/sim/methods/smoothing.h"

namespace rivulet {

namespace {

class Wcsph final : public Method {
  public:
    Wcsph(bool thesis, bool moves) : thesis_(thesis), moves_(moves) {}
    PairKernel density, forces;
    Kernel integrate;

    StepLimit stepLimit(const FluidParams&, float) const override { return {}; }  // sound's is far shorter

    float soundSpeed(const FluidParams& p, float fastest) const override {
        if (thesis_) return std::sqrt(p.stiffness);  // dp/drho of (4)
        // Ten times the fastest flow keeps compression near 1 % (Monaghan 1994).
        return p.soundSpeed > 0 ? p.soundSpeed : 10.0F * fastest;
    }

    void fill(const FluidParams& p, float fastest, StepParams& s) const override {
        const double h = s.h;
        const float c0 = soundSpeed(p, fastest);
        if (thesis_) {
            s.kernelK = static_cast<float>(315.0 / (64.0 * kPiD * std::pow(h, 9)));
            s.gradientK = static_cast<float>(-45.0 / (kPiD * std::pow(h, 6)));
            s.stiffness = p.stiffness;
            s.restitution = 1.0F;  // the thesis's box turns the velocity round
            return;
        }
        fillSmoothing(p, s);
        s.stiffness = c0 * c0 * p.restDensity / 7.0F;
        s.artificial = p.artificialViscosity * c0 * 0.5F * s.h;
    }

    std::vector<float> pressures(Device& device, const Particles& p, const StepParams& s) const override {
        std::vector<float> pascal = device.readAll<float>(p.pressure, p.count);
        if (thesis_) return pascal;
        const std::vector<float> ratio = device.readAll<float>(p.density, p.count);  // the kernels hold p / rho^2
        for (size_t i = 0; i < pascal.size(); ++i) pascal[i] *= ratio[i] * ratio[i] * s.restDensity * s.restDensity;
        return pascal;
    }

    AsleepValues asleepValues(Particles& p, const StepParams& s) override {
        return {{&p.pressure, &p.pressure, s.restDensity, 1.0F / s.restDensity}, {{&p.density, &p.density}}};
    }

    void step(StepContext& c) override {
        if (!c.build(false)) return;
        Particles& p = c.particles;
        const uint32_t threads = c.grid.pairThreads();
        const Buffer& neighbors = c.grid.neighbors();
        if (moves_) {
            density.run(c, c.params, {&neighbors, &p.position, &p.density, &p.pressure}, threads);
            forces.run(c, c.params,
                       {&neighbors, &p.position, &p.velocity, &p.pressure, &p.density, &c.planes, &p.positionNext, &p.velocityNext},
                       p.count);
            return;
        }
        if (thesis_) {
            density.run(c, c.params, {&neighbors, &p.position, &p.density, &p.pressure}, threads);
            forces.run(c, c.params, {&neighbors, &p.position, &p.velocity, &p.pressure, &p.acceleration, &p.density}, threads);
        } else {
            c.nearWalls(p.position);
            density.run(c, c.params, {&neighbors, &p.position, &p.density, &p.pressure, &p.nearWalls}, threads);
            forces.run(c, c.params, {&neighbors, &p.position, &p.velocity, &p.pressure, &p.acceleration, &p.nearWalls}, threads);
            // At a sample the pair has the fluid's pressure twice; one over rho^2 is in the pressures already.
            c.pushSamples(p.position, p.pressure, 2.0F * c.params.restDensity, vec3(0.0F));
            if (c.probes != nullptr)
                c.probes->pressure(c.params, p.position, p.position, p.position, p.pressure,
                                   c.params.restDensity * c.params.mass * c.params.dt);
        }
        c.forces();
        if (c.probes != nullptr) c.probes->response(c.params, p.position, p.velocity, p.acceleration, 1.0F);
        c.device.run(
            integrate, c.params,
            {&c.grid.cellStart(), &p.position, &p.velocity, &p.acceleration, &p.density, &c.planes, &p.positionNext, &p.velocityNext},
            c.params.awakeSlots);
    }

  private:
    bool thesis_;
    bool moves_;  // the forces' sweep moves particles on at once [4.2]
};

Result<std::unique_ptr<Method>> make(Device& device, const MethodSetup& setup, bool thesis) {
    if (thesis && (setup.traits.matter || glm::any(setup.traits.periodic)))
        return badInput(
            "method wcsph_thesis supports one liquid, no floating bodies and no periodic axes: choose another method for this scene");
    const bool moves = setup.traits.linked;
    ASSERT(!moves || thesis, "only wcsph_thesis moves particles on in its sweep of forces");
    auto method = std::make_unique<Wcsph>(thesis, moves);
    std::vector<Define> defines = setup.traits.wallDefines();
    if (thesis) defines.push_back({"THESIS", "1"});
    if (!thesis && setup.params.kernel == "cubic_spline") defines.push_back({"CUBIC", "1"});
    Result<PairKernel> density = PairKernel::find(device, "fluid/methods/wcsph_density", setup.traits, defines);
    if (!density) return density.error();
    if (moves) defines.push_back({"MOVES", "1"});
    Result<PairKernel> forces = PairKernel::find(device, "fluid/methods/wcsph_forces", setup.traits, defines);
    if (!forces) return forces.error();
    method->density = *density;
    method->forces = *forces;
    if (!moves) {
        Result<Kernel> integrate = device.kernel("fluid/methods/integrate", setup.traits.wallDefines(setup.traits.threadDefines()));
        if (!integrate) return integrate.error();
        method->integrate = *integrate;
    }
    return std::unique_ptr<Method>(std::move(method));
}

}  // namespace

MethodRow wcsphMethod() {
    return {.name = "wcsph",
            .doc = "weakly compressible SPH: Tait's equation, walls by signed distance",
            .make = [](Device& device, const MethodSetup& setup) { return make(device, setup, false); },
            .doesViscosity = true,
            .hasSound = true};
}

MethodRow wcsphThesisMethod() {
    return {.name = "wcsph_thesis",
            .doc = "the thesis's SPH: poly6 and spiky kernels, linear equation of state, box walls that reverse the velocity",
            .make = [](Device& device, const MethodSetup& setup) { return make(device, setup, true); },
            .doesViscosity = true,
            .hasSound = true,
            .linkedLists = true,
            .keepsPairs = false};
}

}  // namespace rivulet
