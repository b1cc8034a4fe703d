// DFSPH (Bender and Koschier 2015) as one solve for rates of compression (see dfsph_rate.kernel), with pressures summed over the
// iterations, kept from pulling (negativePressure: at the surface only), and begun with those of the step before.
#include "fluid/sim/methods/method_dfsph.h"

#include <algorithm>
#include <memory>

#include "fluid/sim/methods/method.h"
#include "fluid/sim/methods/particle_shifting.h"
#include "fluid/sim/methods/smoothing.h"
#include "fluid/sim/methods/solver_residual.h"

namespace rivulet {

namespace {

// The speed of sound over that of the flow: compression under pressure is the square of its inverse, at most.
constexpr float kSound = 100.0F;
// The same without a free surface: the mean density of a disordered fluid is above that of a lattice, no particle can escape, and a
// stiff fluid's pressure for it would drown all others.
constexpr float kSoundClosed = 10.0F;
// Iterations that remove most of what a step compresses. Long waves remain, as in deep water, and need more momentum.
constexpr int kFirst = 6;
float squared(float x) { return x * x; }

class Dfsph final : public Method {
  public:
    Kernel integrate, warm, begin, end;
    PairKernel density, rate, push;
    Buffer solve, change, kept;  // change: of the pressures in an iteration; kept: pressures of the last step, by id
    SolverResidual residual;
    ParticleShifting shifting;
    float coupling = 1;   // of the iteration, over that with a support of 2 spacings
    bool closed = false;  // MethodSetup::closed

    float soundSpeed(const FluidParams&, float) const override { return 0.0F; }
    StepLimit stepLimit(const FluidParams& p, float) const override { return {p.dfsph.reach, 1.0 / (60 * p.dfsph.minSubsteps)}; }

    void fill(const FluidParams& p, float fastest, StepParams& s) const override {
        fillSmoothing(p, s);
        // There is no sound: damping is what it is in weakly compressible water.
        s.artificial = p.artificialViscosity * 10.0F * fastest * 0.5F * s.h;
        s.stiffness = squared((closed ? kSoundClosed : kSound) * fastest);
        s.relaxation = p.dfsph.relaxation / coupling;
        s.warmStart = p.dfsph.warmStart;
        s.correction = p.dfsph.correction;
        s.momentum = p.dfsph.momentum;
    }

    std::vector<NamedBuffer> remembered() override { return {{"pressure", &kept}}; }
    AsleepValues asleepValues(Particles& p, const StepParams&) override {
        return {{&p.pressure, &p.pressure, 1.0F, 1.0F}, {{nullptr, &change}}};
    }
    void reset() override { residual.reset(); }

    std::vector<float> pressures(Device& device, const Particles& p, const StepParams& s) const override {
        const std::vector<uint32_t> id = device.readAll<uint32_t>(p.id, p.count);
        const std::vector<float> remembered = device.readAll<float>(kept, p.count);
        std::vector<float> pascal(p.count);
        for (size_t i = 0; i < id.size(); ++i) pascal[i] = remembered[id[i]] * s.restDensity;
        return pascal;
    }

    void step(StepContext& c) override {
        if (!c.build(false)) return;
        Particles& p = c.particles;
        c.nearWalls(p.position);
        StepParams allowed = c.params;
        allowed.force.x = c.fluid.dfsph.negativePressure ? 1.0F : 0.0F;
        c.device.run(warm, allowed, {&c.grid.cellStart(), &p.id, &kept, &p.velocity, &change}, c.params.awakeSlots);
        density.run(c, c.params, {&c.grid.neighbors(), &p.position, &p.nearWalls, &p.density, &solve, &p.velocity, &p.acceleration},
                    c.grid.pairThreads());
        c.forces();
        c.device.run(begin, allowed, {&c.grid.neighbors(), &p.acceleration, &p.nearWalls, &solve, &p.pressure, &p.velocity},
                     c.grid.pairThreads());
        pushBodies(c, p.pressure, c.params.dt, vec3(c.params.gravity));
        iterate(c);
        c.solve.iterations = residual.iterations();
        c.solve.residual = residual.value();
        c.device.run(end, c.params, {&c.grid.cellStart(), &p.id, &solve, &kept, &p.pressure}, c.params.awakeSlots);
        if (c.probes != nullptr) c.probes->solved(c.params, solve);
        if (c.fluid.dfsph.negativePressure) shifting.run(c, p.pressure, squared(c.params.dt / c.params.spacing), solve);
        const Buffer& from = c.fluid.dfsph.negativePressure ? solve : p.position;
        if (c.probes != nullptr) c.probes->response(c.params, from, p.velocity, p.acceleration, 0.0F);
        c.device.run(integrate, c.params,
                     {&c.grid.cellStart(), &from, &p.velocity, &p.acceleration, &p.density, &c.planes, &p.positionNext, &p.velocityNext},
                     c.params.awakeSlots);
    }

  private:
    // `unit` times these pressures, m^2/s, push bodies, and go on into them by `weight` a metre (Adami et al. 2012).
    void pushBodies(StepContext& c, const Buffer& pressures, float unit, const vec3& weight) {
        c.pushSamples(c.particles.position, pressures, 2.0F * unit / c.params.dt, weight);  // MIRRORED
    }
    // Runs the solver to its tolerance.
    void iterate(StepContext& c) {
        Particles& p = c.particles;
        const DfsphParams& d = c.fluid.dfsph;
        const bool cpu = c.device.backend() == Backend::cpu;
        const int most = cpu ? d.maxIterations : residual.iterationsToQueue(d.maxIterations);
        StepParams s = c.params;
        s.stiffness = std::max(s.stiffness, squared((closed ? kSoundClosed : kSound) * static_cast<float>(c.fastest)));
        for (int k = 0; k < most; ++k) {
            // Not its number: a device keeps few different blocks of params at hand.
            s.iteration = k < 1 ? 0 : k < kFirst ? 1 : 2;
            s.momentum = k < kFirst ? d.momentum : 1.0F - squared(1.0F - d.momentum);
            rate.run(c, s, {&c.grid.neighbors(), &p.position, &p.velocity, &p.nearWalls, &solve, &change, &residual.progress()},
                     c.grid.pairThreads());
            push.run(c, s, {&c.grid.neighbors(), &p.position, &p.velocity, &p.nearWalls, &change, &residual.progress()},
                     c.grid.pairThreads());
            pushBodies(c, change, 1.0F, vec3(0.0F));
            if (residual.converged(c, solve, double{d.tolerance}, double{d.reach * c.fluid.spacing}, k)) break;
        }
        if (!cpu) residual.readLater(c);
    }
};

Result<std::unique_ptr<Method>> makeDfsph(Device& device, const MethodSetup& setup) {
    if (setup.params.kernel != "wendland")
        return badInput("fluid.kernel \"" + setup.params.kernel + "\" is only for method wcsph: use wendland with method dfsph");
    auto m = std::make_unique<Dfsph>();
    const double support = setup.params.supportSpacings;
    m->coupling = static_cast<float>(std::max(wendlandCoupling(support) / wendlandCoupling(2), 1.0));
    m->closed = setup.closed;
    struct Wanted {
        Kernel* kernel;
        const char* path;
        std::vector<Define> defines;
    };
    for (const Wanted& w : {Wanted{&m->integrate, "fluid/methods/integrate", setup.traits.wallDefines({{"COAST", "1"}})},
                            Wanted{&m->warm, "fluid/methods/dfsph_warm", {}},
                            Wanted{&m->begin, "fluid/methods/dfsph_begin", setup.traits.wallDefines(setup.traits.threadDefines())},
                            Wanted{&m->end, "fluid/methods/dfsph_end", {}}}) {
        Result<Kernel> found = device.kernel(w.path, w.defines);
        if (!found) return found.error();
        *w.kernel = *found;
    }
    for (auto [kernel, path] : {std::pair(&m->density, "fluid/methods/dfsph_density"), std::pair(&m->rate, "fluid/methods/dfsph_rate"),
                                std::pair(&m->push, "fluid/methods/dfsph_push")}) {
        Result<PairKernel> found = PairKernel::find(device, path, setup.traits, setup.traits.wallDefines());
        if (!found) return found.error();
        *kernel = *found;
    }
    Result<SolverResidual> residual = SolverResidual::create(device, {});
    if (!residual) return residual.error();
    m->residual = std::move(*residual);
    Result<ParticleShifting> shifting = ParticleShifting::create(device, setup.traits);
    if (!shifting) return shifting.error();
    m->shifting = *shifting;
    const size_t count = setup.count;
    for (auto [buffer, bytes] : {std::pair(&m->solve, count * sizeof(vec4)), std::pair(&m->change, count * sizeof(float)),
                                 std::pair(&m->kept, count * sizeof(float))}) {
        Result<Buffer> made = device.allocate(bytes);
        if (!made) return made.error();
        *buffer = std::move(*made);
    }
    return std::unique_ptr<Method>(std::move(m));
}

}  // namespace

void DfsphParams::visit(ParamVisitor& v) {
    v.value({"tolerance", "",
             "mean compression that one substep may add, as a fraction, if the fastest particle moves by reach; smaller in slower water, "
             "down to a twentieth",
             1.0e-6, 0.1, kLog},
            tolerance);
    v.value(
        {"correction", "",
         "share of the density error that one substep corrects: 1 is most accurate and heats water at rest, 0 lets density drift", 0, 1},
        correction);
    v.value({"maxIterations", "", "limit on solver iterations per substep", 1, 1000, kLog}, maxIterations);
    v.value({"warmStart", "", "share of the last substep's pressure that the solver starts from", 0, 1}, warmStart);
    v.value({"relaxation", "", "share of each Jacobi correction that is applied; above 0.6 the solver may not converge", 0.05, 1},
            relaxation);
    v.value(
        {"momentum", "",
         "momentum of the Jacobi iteration: share of the last change that is added again, unless it points the wrong way; from the seventh "
         "iteration on 1 - (1 - momentum)^2",
         0, 0.95},
        momentum);
    v.value({"reach", "", "longest path of the fastest particle in one substep, in spacings", 0.05, 1}, reach);
    v.value({"minSubsteps", "", "minimum of substeps per 1/60 s: more keeps the density more accurate", 1, 100}, minSubsteps);
    v.value({.name = "negativePressure",
             .doc = "whether pressure inside the fluid may be negative: it then holds together where no air can get in, as in a siphon; "
                    "costs up to twice as much, and tears where steps are long for the size of the particles"},
            negativePressure);
}

MethodRow dfsphMethod() {
    return {.name = "dfsph",
            .doc = "divergence-free SPH: one pressure solve to a tolerance corrects divergence and density; the accurate method",
            .make = makeDfsph,
            .leastSubsteps = [](const FluidParams& p) { return p.dfsph.minSubsteps; },
            .visit = [](FluidParams& p, ParamVisitor& v) { v.group({.name = "dfsph", .doc = "settings of method dfsph"}, p.dfsph); }};
}

}  // namespace rivulet
