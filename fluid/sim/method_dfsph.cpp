// DFSPH (Bender and Koschier 2015) as one solve for rates of compression (see dfsph_rate.kernel), with pressures summed over the
// iterations, kept from pulling, and begun with those of the step before.
#include "fluid/sim/method_dfsph.h"

#include <algorithm>
#include <memory>

#include "fluid/sim/smoothing.h"
#include "shaders/fluid/stats_row.h"

namespace rivulet {

namespace {

// The speed of sound over that of the flow: compression under pressure is the square of its inverse, at most.
constexpr float kSound = 100.0F;
float squared(float x) { return x * x; }

// What is known of the residual: at once on the cpu, some frames late on a GPU.
struct Residual {
    double value = 0;
    bool known = false;
};

class Dfsph final : public Method {
  public:
    Kernel integrate, begin, end, residual;
    PairKernel density, rate, push;
    Buffer solve, pressures, rows;  // pressures: remembered, by id

    float soundSpeed(const FluidParams&, float) const override { return 0.0F; }
    StepLimit stepLimit(const FluidParams& p) const override { return {p.dfsph.reach, 1.0 / (60 * p.dfsph.minSubsteps)}; }

    void fill(const FluidParams& p, float fastest, StepParams& s) const override {
        fillSmoothing(p, s);
        // There is no sound: damping is what it is in weakly compressible water.
        s.artificial = p.artificialViscosity * 10.0F * fastest * 0.5F * s.h;
        s.stiffness = glm::length(vec3(s.gravity)) > 0 ? squared(kSound * fastest) : 0.0F;
        s.relaxation = p.dfsph.relaxation;
        s.warmStart = p.dfsph.warmStart;
        s.correction = p.dfsph.correction;
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
        c.forces();
        c.device.run(begin, c.params, {&c.grid.cellStart(), &p.id, &pressures, &p.acceleration, &solve, &p.pressure, &p.velocity}, p.count);
        pushOn(c, vec3(c.params.gravity) * c.params.dt);
        // What is left trembles: it is to be little beside what moves.
        const double way = c.fastest * double{c.params.dt} / double{d.reach * c.fluid.spacing};
        c.solve.iterations = iterate(c, double{d.tolerance} * std::clamp(way, 0.05, 1.0));
        c.solve.residual = residual_->value;
        c.device.run(end, c.params, {&c.grid.cellStart(), &p.id, &solve, &pressures}, p.count);
        c.device.run(
            integrate, c.params,
            {&c.grid.cellStart(), &p.position, &p.velocity, &p.acceleration, &p.density, &c.planes, &p.positionNext, &p.velocityNext},
            p.count);
    }

  private:
    // Velocities follow the change in p.pressure, which goes on into bodies by `weight` a metre (Adami et al. 2012).
    void pushOn(StepContext& c, const vec3& weight) {
        Particles& p = c.particles;
        StepParams s = c.params;
        s.force = vec4(weight, 0.0F);
        push.run(c, s, {&c.grid.neighbors(), &p.position, &p.velocity, &p.boundary, &p.pressure}, c.grid.pairThreads());
        c.pushSamples(p.position, p.pressure, 2.0F / c.params.dt, weight);  // MIRRORED
    }
    // Runs the solver to its tolerance (compression a step, a fraction); returns the number of iterations.
    int iterate(StepContext& c, double tolerance) {
        Particles& p = c.particles;
        const uint32_t threads = c.grid.pairThreads();
        const Buffer& neighbors = c.grid.neighbors();
        const bool cpu = c.device.backend() == Backend::cpu;
        const int most = c.fluid.dfsph.maxIterations;
        // On a GPU nothing waits for the residual: as many iterations as the last one known asked for, one more or fewer.
        if (!cpu && residual_->known) {
            planned_ += residual_->value > tolerance ? 1 : residual_->value < 0.5 * tolerance ? -1 : 0;
            residual_->known = false;
        }
        planned_ = std::clamp(planned_, 1, most);
        double before = 0;
        StepParams s = c.params;
        s.stiffness = std::max(s.stiffness, squared(kSound * static_cast<float>(c.fastest)));
        int k = 0;
        while (true) {
            s.iteration = static_cast<uint32_t>(k);
            rate.run(c, s, {&neighbors, &p.position, &p.velocity, &p.boundary, &solve, &p.pressure}, threads);
            pushOn(c, vec3(0.0F));
            ++k;
            if (cpu) {
                const double r = readResidual(c, *residual_);
                // What has just been applied will leave about as much of it as the iteration before left.
                const double kept = k > 1 && before > 0 ? std::clamp(r / before, 0.3, 0.95) : 0.6;
                before = r;
                if (r * kept <= tolerance || k >= most) break;
            } else if (k >= planned_) {
                askResidual(c, residual_);
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

    int planned_ = 3;  // until a residual is known
    std::shared_ptr<Residual> residual_ = std::make_shared<Residual>();
};

}  // namespace

Result<std::unique_ptr<Method>> makeDfsph(Device& device, const MethodSetup& setup) {
    if (setup.params.kernel != "wendland")
        return badInput("fluid.kernel \"" + setup.params.kernel + "\" is for method wcsph: method dfsph works with wendland");
    auto m = std::make_unique<Dfsph>();
    const Define coast{"COAST", "1"};
    struct Wanted {
        Kernel* kernel;
        const char* path;
        std::vector<Define> defines;
    };
    for (const Wanted& w : {Wanted{&m->integrate, "fluid/integrate", {coast}}, Wanted{&m->begin, "fluid/dfsph_begin", {}},
                            Wanted{&m->end, "fluid/dfsph_end", {}}, Wanted{&m->residual, "fluid/residual", {}}}) {
        Result<Kernel> found = device.kernel(w.path, w.defines);
        if (!found) return found.error();
        *w.kernel = *found;
    }
    for (auto [kernel, path] : {std::pair(&m->density, "fluid/dfsph_density"), std::pair(&m->rate, "fluid/dfsph_rate"),
                                std::pair(&m->push, "fluid/dfsph_push")}) {
        Result<PairKernel> found = PairKernel::find(device, path, setup.traits);
        if (!found) return found.error();
        *kernel = *found;
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
