// DFSPH (Bender and Koschier 2015), with pressures summed over the iterations and kept from pulling.
#include "fluid/sim/method_dfsph.h"

#include <algorithm>
#include <memory>

#include "fluid/sim/smoothing.h"
#include "shaders/fluid/stats_row.h"

namespace rivulet {

namespace {

// What is known of the residual: at once on the cpu, some frames late on a GPU.
struct Residual {
    double value = 0;
    bool known = false;
};

class Dfsph final : public Method {
  public:
    Kernel kick, integrate, begin, end, residual;
    PairKernel density, rate, divergence, push;
    Buffer solve, pressures, rows;  // pressures: remembered, by id

    float soundSpeed(const FluidParams&, float) const override { return 0.0F; }
    StepLimit stepLimit(const FluidParams& p) const override { return {p.dfsph.reach, 1.0 / (60 * p.dfsph.minSubsteps)}; }

    void fill(const FluidParams& p, float fastest, StepParams& s) const override {
        fillSmoothing(p, s);
        // There is no sound: the flow's own speed is what the damping is measured by.
        s.artificial = p.artificialViscosity * fastest * 0.5F * s.h;
        s.relaxation = p.dfsph.relaxation;
        s.warmStart = p.dfsph.warmStart;
        s.warmGate = p.dfsph.warmGate;
        s.momentum = p.dfsph.momentum;
    }

    std::vector<NamedBuffer> remembered() override { return {{"pressure", &pressures}}; }

    void step(StepContext& c) override {
        if (!c.build(false)) return;
        Particles& p = c.particles;
        const DfsphParams& d = c.fluid.dfsph;
        c.boundary(p.position);
        density.run(c, c.params, {&c.grid.neighbors(), &p.position, &p.boundary, &p.density, &solve, &p.velocity, &p.acceleration},
                    c.grid.pairThreads());
        if (d.divergence) iterate(c, divergence, d.divergenceTolerance * c.params.dt, 1, plannedDivergence_, divergenceResidual_);
        c.forces();
        c.device.run(kick, c.params, {&c.grid.cellStart(), &p.acceleration, &p.velocity}, p.count);
        c.device.run(begin, c.params, {&c.grid.cellStart(), &p.id, &pressures, &solve, &p.pressure}, p.count);
        pushOn(c);
        c.solve.iterations = iterate(c, rate, d.tolerance, 1, planned_, residual_);
        c.solve.residual = residual_->value;
        c.device.run(end, c.params, {&c.grid.cellStart(), &p.id, &solve, &pressures}, p.count);
        c.device.run(
            integrate, c.params,
            {&c.grid.cellStart(), &p.position, &p.velocity, &p.acceleration, &p.density, &c.planes, &p.positionNext, &p.velocityNext},
            p.count);
    }

  private:
    // Velocities follow the change in p.pressure.
    void pushOn(StepContext& c) {
        Particles& p = c.particles;
        push.run(c, c.params, {&c.grid.neighbors(), &p.position, &p.velocity, &p.boundary, &p.pressure}, c.grid.pairThreads());
        c.pushSamples(p.position, p.pressure, 1.0F / c.params.dt);
    }
    // Runs one solver to its tolerance (compression a step, a fraction); returns the number of iterations.
    int iterate(StepContext& c, const PairKernel& measure, double tolerance, int atLeast, int& planned, std::shared_ptr<Residual>& last) {
        Particles& p = c.particles;
        const uint32_t threads = c.grid.pairThreads();
        const Buffer& neighbors = c.grid.neighbors();
        const bool cpu = c.device.backend() == Backend::cpu;
        const int most = std::max(c.fluid.dfsph.maxIterations, atLeast);
        // On a GPU nothing waits for the residual: as many iterations as the last one known asked for, one more or fewer.
        if (!cpu && last->known) {
            planned += last->value > tolerance ? 1 : last->value < 0.5 * tolerance ? -1 : 0;
            last->known = false;
        }
        planned = std::clamp(planned, atLeast, most);
        double before = 0;
        StepParams s = c.params;
        int k = 0;
        while (true) {
            s.iteration = static_cast<uint32_t>(k);
            measure.run(c, s, {&neighbors, &p.position, &p.velocity, &p.boundary, &solve, &p.pressure}, threads);
            pushOn(c);
            ++k;
            if (cpu) {
                const double r = readResidual(c, *last);
                // What has just been applied will leave about as much of it as the iteration before left.
                const double kept = k > 1 && before > 0 ? std::clamp(r / before, 0.3, 0.95) : 0.6;
                before = r;
                if ((k >= atLeast && r * kept <= tolerance) || k >= most) break;
            } else if (k >= planned) {
                askResidual(c, last);
                break;
            }
        }
        return k;
    }

    double readResidual(StepContext& c, Residual& into) {
        c.device.run(residual, c.params, {&c.grid.cellStart(), &solve, &rows}, STATS_THREADS);
        c.device.readLater(rows, rows.bytes(), [&into](std::span<const std::byte> bytes) { into = sum(bytes); });
        return into.value;
    }
    void askResidual(StepContext& c, const std::shared_ptr<Residual>& into) {
        c.device.run(residual, c.params, {&c.grid.cellStart(), &solve, &rows}, STATS_THREADS);
        c.device.readLater(rows, rows.bytes(), [into](std::span<const std::byte> bytes) { *into = sum(bytes); });
    }
    static Residual sum(std::span<const std::byte> bytes) {
        const float* values = reinterpret_cast<const float*>(bytes.data());
        double total = 0;
        for (uint32_t t = 0; t < STATS_THREADS; ++t) total += double{values[t]};
        return {total / std::max(1.0, double{values[STATS_THREADS]}), true};
    }

    int planned_ = 3, plannedDivergence_ = 3;  // until a residual is known
    std::shared_ptr<Residual> residual_ = std::make_shared<Residual>(), divergenceResidual_ = std::make_shared<Residual>();
};

}  // namespace

Result<std::unique_ptr<Method>> makeDfsph(Device& device, const MethodSetup& setup) {
    if (setup.params.kernel != "wendland")
        return badInput("fluid.kernel \"" + setup.params.kernel + "\" is for method wcsph: method dfsph works with wendland");
    auto m = std::make_unique<Dfsph>();
    const Define coast{"COAST", "1"}, divergence{"DIVERGENCE", "1"};
    struct Wanted {
        Kernel* kernel;
        const char* path;
        std::vector<Define> defines;
    };
    for (const Wanted& w :
         {Wanted{&m->kick, "fluid/kick", {}}, Wanted{&m->integrate, "fluid/integrate", {coast}}, Wanted{&m->begin, "fluid/dfsph_begin", {}},
          Wanted{&m->end, "fluid/dfsph_end", {}}, Wanted{&m->residual, "fluid/residual", {}}}) {
        Result<Kernel> found = device.kernel(w.path, w.defines);
        if (!found) return found.error();
        *w.kernel = *found;
    }
    struct WantedPair {
        PairKernel* kernel;
        const char* path;
        std::vector<Define> defines;
    };
    for (const WantedPair& w :
         {WantedPair{&m->density, "fluid/dfsph_density", {}}, WantedPair{&m->rate, "fluid/dfsph_rate", {}},
          WantedPair{&m->divergence, "fluid/dfsph_rate", {divergence}}, WantedPair{&m->push, "fluid/dfsph_push", {}}}) {
        Result<PairKernel> found = PairKernel::find(device, w.path, setup.traits, w.defines);
        if (!found) return found.error();
        *w.kernel = *found;
    }
    const size_t count = setup.count;
    for (auto [buffer, bytes] : {std::pair(&m->solve, count * sizeof(vec4)), std::pair(&m->pressures, count * sizeof(float)),
                                 std::pair(&m->rows, (STATS_THREADS + 1) * sizeof(float))}) {
        Result<Buffer> made = device.allocate(bytes);
        if (!made) return made.error();
        *buffer = std::move(*made);
    }
    return std::unique_ptr<Method>(std::move(m));
}

}  // namespace rivulet
