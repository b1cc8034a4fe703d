// Position Based Fluids (Macklin and Mueller 2013).
#include "fluid/sim/methods/method_pbf.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "fluid/sim/methods/method.h"
#include "fluid/sim/methods/smoothing.h"
#include "fluid/sim/methods/solver_residual.h"

namespace rivulet {

namespace {

// The length of the cycles of a substep's corrections. They are short, because eigenvalues change when particles come into contact.
int cycleOf(int corrections) {
    constexpr int kLongest = 5;
    const int cycles = (corrections + kLongest - 1) / kLongest;
    return (corrections + cycles - 1) / cycles;
}

// The weight of correction k in cycles of `length`: Chebyshev's semi-iteration (Golub and Varga 1961, "Chebyshev semi-iterative methods",
// Numer. Math. 3). A density error is a sum of waves, and a correction of weight w multiplies a wave of eigenvalue e by 1 - w e. With one
// weight for all corrections either the shortest waves grow, and water at rest boils, or the longest remain, and water is soft. The weights
// of one cycle together reduce all waves with eigenvalues between 1 / 7 of the coupling and a tenth above it (the coupling is that of a
// lattice; particles in disorder have a little more). Small weights come first: they remove the waves that large ones amplify.
double correctionWeight(int k, int length, double coupling) {
    const double least = coupling / 7, most = 1.1 * coupling;
    return 2 / (most + least + (most - least) * std::cos((k % length + 0.5) * kPiD / length));
}

class Pbf final : public Method {
  public:
    Kernel predict, finish, kick, weigh, setRatio;
    PairKernel lambda, shift;
    double coupling = 1;         // see wendlandCoupling
    Buffer corrected[2], given;  // given: multipliers, summed over the iterations of the last step
    SolverResidual residual;
    int corrections = 1;   // of a step
    bool swapped = false;  // position and velocity, see the end of step()

    float soundSpeed(const FluidParams&, float) const override { return 0.0F; }
    // A column at rest is as much too dense as its weight asks of the corrections of a step: a g H dt^2 / (k h^2) on its floor, a the
    // diagonal of a lattice over h^2. Where that comes to a tenth, corrections throw particles about: seen at 0.36 to 0.48 h sqrt(k / a) /
    // sqrt(2 g H). Few corrections that go the whole way overshoot, and stand less.
    StepLimit stepLimit(const FluidParams& p, float fastest) const override {
        constexpr double kDiagonal = 1.9, kShare = 0.35;
        const double k = p.pbf.tolerance > 0 ? p.pbf.maxIterations : p.pbf.iterations, r = p.pbf.relaxation;
        const double beyond = std::max(r - 0.7, 0.0) / k, h = double{p.supportSpacings} * double{p.spacing};
        const double holds = kShare / (1 + 20 * beyond * beyond) * h * std::sqrt(k * r / kDiagonal) / std::max(double{fastest}, 1.0e-9);
        const double asked = 1.0 / (60 * p.pbf.minSubsteps);
        if (holds < asked) return {p.pbf.reach, holds, "the weight that fluid.pbf.iterations can support"};
        return {p.pbf.reach, asked};
    }

    void fill(const FluidParams& p, float, StepParams& s) const override {
        fillSmoothing(p, s);
        s.relaxation = p.pbf.relaxation;
        s.wallMargin = 0.5F * s.spacing;
    }

    std::vector<float> pressures(Device& device, const Particles& p, const StepParams& s) const override {
        std::vector<float> pascal = device.readAll<float>(given, p.count);
        for (float& x : pascal) x *= s.restDensity / (s.dt * s.dt);
        return pascal;
    }

    // A neighbour that sleeps moves the others by the same share of its multiplier in each correction: their number must be known.
    const char* keepsAwake(const FluidParams& p) const override { return p.pbf.tolerance > 0 ? "fluid.pbf.tolerance is above 0" : nullptr; }
    AsleepValues asleepValues(Particles& p, const StepParams& s) override {
        const float dt2 = s.dt * s.dt;
        return {{&given, &p.pressure, 1.0F / dt2, dt2 / static_cast<float>(corrections)}, {{&given, &given}}};
    }
    void reset() override { residual.reset(); }

    bool predicts() const override { return true; }
    void step(StepContext& c) override {
        Particles& p = c.particles;
        // The sort writes only the slots of particles that are awake: the others' must be where it left them.
        if (swapped) p.position.swap(p.velocity);
        swapped = false;
        corrections = c.fluid.pbf.iterations;
        if (c.probes != nullptr) c.probes->predicted(c.params);
        // On the cpu alone a sort can fail.
        const bool cpu = c.device.backend() == Backend::cpu;
        const uint32_t slots = c.params.awakeSlots;
        const size_t bytes = size_t{slots} * sizeof(vec4);
        if (cpu) {
            c.device.copy(p.positionNext, corrected[0], bytes);
            c.device.copy(p.velocityNext, corrected[1], bytes);
        }
        c.device.run(predict, c.params, {&p.id, &c.planes, &p.positionNext, &p.velocityNext}, slots);
        c.grid.setMargin(1.05F);  // as pbf_lambda keeps
        if (!c.build(true)) {
            c.device.copy(corrected[0], p.positionNext, bytes);
            c.device.copy(corrected[1], p.velocityNext, bytes);
            return;
        }
        // p.position: predicted; p.velocity: where each particle comes from.
        const uint32_t threads = c.grid.pairThreads();
        const Buffer& neighbors = c.grid.neighbors();
        const Buffer* at = &p.position;
        // Samples on bodies and sleeping particles are never corrected, but looked at there.
        if (c.params.firstSample < c.params.count || (c.params.asleepSets > 0 && slots == p.count))
            for (Buffer& b : corrected) c.device.copy(p.position, b, bytes);
        const PbfParams& pbf = c.fluid.pbf;
        const bool toTolerance = pbf.tolerance > 0;
        const int most = !toTolerance ? pbf.iterations
                         : cpu        ? pbf.maxIterations
                                      : residual.plannedIterations(double{pbf.tolerance}, pbf.maxIterations);
        const int cycle = cycleOf(most);
        int k = 0;
        StepParams s = c.params;
        // Pressures on bodies grow by the weight of the water beyond the particle (Adami et al. 2012), a part in each correction.
        s.force = vec4(vec3(c.params.gravity) * (c.params.dt * c.params.dt / static_cast<float>(most)), 0.0F);
        // Walls are found where particles come from, because predictions and corrections may lie inside a mesh.
        c.nearWalls(p.velocity);
        const Buffer* last = &p.velocity;
        for (; k < most; ++k) {
            s.iteration = static_cast<uint32_t>(k);
            c.followWalls(*last, *at);
            last = at;
            s.relaxation = c.params.relaxation * static_cast<float>(correctionWeight(k, cycle, coupling));
            lambda.run(c, s, {&neighbors, &p.position, at, &p.nearWalls, &p.density, &p.pressure}, threads);
            if (toTolerance && (cpu || k + 1 == most)) {
                const double left = residual.measure(c, p.density);
                if (cpu && k > 0 && k % cycle == 0 && left <= double{pbf.tolerance}) break;
            }
            shift.run(c, s, {&neighbors, &p.position, at, &p.nearWalls, &p.pressure, &corrected[k % 2], &given}, threads);
            c.pushSamples(*at, p.pressure, 2.0F / (c.params.dt * c.params.dt), vec3(s.force));  // MIRRORED
            if (c.probes != nullptr) c.probes->pressure(c.params, p.position, p.velocity, *at, p.pressure, c.params.mass / c.params.dt);
            at = &corrected[k % 2];
        }
        c.solve.iterations = k;
        if (toTolerance) c.solve.residual = residual.value();
        if (c.probes != nullptr) c.probes->responseFromPositions(c.params, p.velocity, *at);
        c.device.run(finish, c.params,
                     {&c.grid.cellStart(), &p.position, at, &p.velocity, &p.density, &c.planes, &p.positionNext, &p.velocityNext}, slots);
        // The other forces act on the velocity that came out; the next step's prediction follows it.
        if (c.hasForces) {
            p.velocity.swap(p.velocityNext);
            c.device.run(weigh, c.noGravity(), {&c.grid.cellStart(), &p.acceleration}, slots);
            c.forces();
            c.device.run(kick, c.params, {&c.grid.cellStart(), &p.acceleration, &p.velocity}, slots);
            p.velocity.swap(p.velocityNext);
        }
        p.position.swap(p.velocity);  // what follows walks from where the step began
        swapped = true;
    }

    void measure(StepContext& c) override {
        Particles& p = c.particles;
        c.nearWalls(p.positionNext);
        // p.velocity: where the grid was built, see the end of step().
        lambda.run(c, c.params, {&c.grid.neighbors(), &p.velocity, &p.positionNext, &p.nearWalls, &p.density, &p.pressure},
                   c.grid.pairThreads());
        c.device.run(setRatio, c.params, {&c.grid.cellStart(), &p.density, &p.positionNext}, c.params.awakeSlots);
    }
};

Result<std::unique_ptr<Method>> makePbf(Device& device, const MethodSetup& setup) {
    if (setup.params.kernel != "wendland")
        return badInput("fluid.kernel \"" + setup.params.kernel + "\" is only for method wcsph: use wendland with method pbf");
    auto m = std::make_unique<Pbf>();
    m->coupling = wendlandCoupling(setup.params.supportSpacings);
    const std::vector<Define> walls = setup.traits.wallDefines();
    for (auto [kernel, path, defines] :
         {std::tuple(&m->predict, "fluid/methods/pbf_predict", walls), std::tuple(&m->finish, "fluid/methods/pbf_finish", walls),
          std::tuple(&m->kick, "fluid/methods/kick", std::vector<Define>()),
          std::tuple(&m->weigh, "fluid/forces/weigh", std::vector<Define>()),
          std::tuple(&m->setRatio, "fluid/world/set_ratio", std::vector<Define>())}) {
        Result<Kernel> found = device.kernel(path, defines);
        if (!found) return found.error();
        *kernel = *found;
    }
    for (auto [kernel, path] : {std::pair(&m->lambda, "fluid/methods/pbf_lambda"), std::pair(&m->shift, "fluid/methods/pbf_shift")}) {
        Result<PairKernel> found = PairKernel::find(device, path, setup.traits, walls);
        if (!found) return found.error();
        *kernel = *found;
    }
    const Define density{"DENSITY", "1"};
    Result<SolverResidual> residual = SolverResidual::create(device, std::span(&density, 1));
    if (!residual) return residual.error();
    m->residual = std::move(*residual);
    for (auto [buffer, bytes] :
         {std::pair(&m->corrected[0], sizeof(vec4)), std::pair(&m->corrected[1], sizeof(vec4)), std::pair(&m->given, sizeof(float))}) {
        Result<Buffer> made = device.allocate(size_t{setup.count} * bytes);
        if (!made) return made.error();
        *buffer = std::move(*made);
    }
    return std::unique_ptr<Method>(std::move(m));
}

}  // namespace

void PbfParams::visit(ParamVisitor& v) {
    v.value({"iterations", "", "corrections per substep if tolerance is 0: more is stiffer and slower", 1, 50}, iterations);
    v.value({"tolerance", "", "mean compression, as a fraction, at which corrections stop; 0 = always the number of iterations", 0, 0.1},
            tolerance);
    v.value({"maxIterations", "", "limit on corrections per substep if tolerance is not 0", 1, 1000, kLog}, maxIterations);
    v.value({"relaxation", "", "factor of the weights of the corrections: above 1 particles at rest oscillate, smaller makes water softer",
             0.05, 2.5},
            relaxation);
    v.value({"reach", "", "longest path of the fastest particle in one substep, in spacings", 0.05, 1}, reach);
    v.value({"minSubsteps", "", "minimum of substeps per 1/60 s: more makes water stiffer", 1, 100}, minSubsteps);
}

MethodRow pbfMethod() {
    return {.name = "pbf",
            .doc = "position based fluids: a few position corrections per substep; the fast method",
            .make = makePbf,
            .leastSubsteps = [](const FluidParams& p) { return p.pbf.minSubsteps; },
            .visit = [](FluidParams& p, ParamVisitor& v) { v.group({.name = "pbf", .doc = "settings of method pbf"}, p.pbf); }};
}

}  // namespace rivulet
