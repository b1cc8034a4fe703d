// Explicit: one sweep. Implicit: (1 - dt nu L) u = b by conjugate gradients without a matrix (the operator of Weiler et al. 2018, a step of
// Chronopoulos and Gear 1989: one reduction an iteration). There is no preconditioner: every direction of the search is then a viscous
// acceleration itself, so momentum and angular momentum stay however soon one stops, which with a diagonal one they do not.
#include "fluid/sim/forces/force_viscosity.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "fluid/sim/forces/force.h"
#include "shaders/fluid/world/stats_row.h"

namespace rivulet {

double explicitViscousLimit(const FluidParams& p) {
    const double hs = 0.5 * double{p.supportSpacings} * double{p.spacing};
    return p.viscosity > 0 ? 0.125 * hs * hs / double{p.viscosity} : 1.0e30;
}

namespace force_viscosity {

namespace {

// What is known of the last solve: at once on the cpu, some frames late on a GPU.
struct Left {
    float squared = 0, start = 0, whole = 0;  // r . r, at the start, u . u at the start
    bool known = false;
    double goal = 0;  // r . r to stop at
};

class Viscosity {
  public:
    PairKernel explicit_, onSamples, start, apply;
    Kernel drag, guess, sum, scalars, update, finish;
    Buffer friction, solved, left, applied, direction, changed, rows, result;
    bool samples = false, doesViscosity = false, walled = true;

    void run(StepContext& c) {
        const bool walls = walled && c.fluid.collision.walls == "no-slip" && c.wallFriction;
        if (walls) c.wallFriction(c.particles.position, friction);
        walls_ = walls;
        if (doesViscosity)
            dragWalls(c);
        else if (isImplicit(c))
            solve(c);
        else
            explicitly(c);
    }

  private:
    static bool isImplicit(const StepContext& c) {
        if (c.fluid.forces.viscosity != "auto") return c.fluid.forces.viscosity == "implicit";
        return double{c.params.dt} > explicitViscousLimit(c.fluid) * (1 + 1.0e-6);
    }

    void dragWalls(StepContext& c) {
        Particles& p = c.particles;
        if (!walls_) return;
        std::vector<const Buffer*> buffers = {&c.grid.cellStart(), &p.velocity, &friction, &p.acceleration};
        if (explicit_.matter) buffers.push_back(&p.matter);
        c.device.dispatch(drag, std::as_bytes(std::span(&c.params, 1)), buffers, c.params.awakeSlots);
        if (c.probes != nullptr) c.probes->friction(c.params, friction, p.velocity);
    }

    void explicitly(StepContext& c) {
        Particles& p = c.particles;
        explicit_.run(c, c.params, {&c.grid.neighbors(), &p.position, &p.velocity, &p.acceleration}, c.grid.pairThreads());
        pushSamples(c, p.velocity);
        dragWalls(c);
    }

    void pushSamples(StepContext& c, const Buffer& velocity) {
        if (!samples) return;
        onSamples.run(c, c.params, {&c.grid.neighbors(), &c.particles.position, &velocity, &c.particles.acceleration},
                      c.grid.sampleThreads());
    }

    void solve(StepContext& c) {
        Particles& p = c.particles;
        Device& device = c.device;
        const bool cpu = device.backend() == Backend::cpu;
        const int most = c.fluid.forces.viscosityIterations;
        if (!walls_ && frictionWritten_) device.fill(friction, 0);
        frictionWritten_ = walls_;
        const Buffer &neighbors = c.grid.neighbors(), &cells = c.grid.cellStart();
        const uint32_t threads = c.grid.pairThreads();
        if (!cpu && last_->known) {
            planned_ = std::clamp(planned_ + (last_->squared > last_->goal ? 2 : last_->squared < 0.1 * last_->goal ? -1 : 0), 1, most);
            last_->known = false;
        }
        std::vector<const Buffer*> buffers = {&cells, &p.velocity, &p.acceleration, &solved, &left};
        if (explicit_.matter) buffers.push_back(&p.matter);
        device.dispatch(guess, std::as_bytes(std::span(&c.params, 1)), buffers, c.params.awakeSlots);
        start.run(c, c.params, {&neighbors, &p.position, &solved, &friction, &left}, threads);
        StepParams s = c.params;
        const double tolerance = c.fluid.forces.viscosityTolerance;
        int k = 0;
        for (; k < (cpu ? most : std::min(planned_, most)); ++k) {
            s.iteration = static_cast<uint32_t>(k);
            apply.run(c, s, {&neighbors, &p.position, &left, &friction, &applied}, threads);
            device.run(sum, s, {&cells, &solved, &left, &applied, &rows}, STATS_THREADS);
            device.run(scalars, s, {&rows, &result}, 1);
            if (cpu) {
                device.readLater(result, result.bytes(), [&](std::span<const std::byte> b) { *last_ = read(b, tolerance); });
                if (last_->squared <= last_->goal) break;
            }
            device.run(update, s, {&cells, &result, &applied, &solved, &left, &direction, &changed}, c.params.awakeSlots);
        }
        if (!cpu)
            device.readLater(result, result.bytes(),
                             [into = last_, tolerance](std::span<const std::byte> b) { *into = read(b, tolerance); });
        device.run(finish, c.params, {&cells, &p.velocity, &solved, &left, &p.acceleration}, c.params.awakeSlots);
        pushSamples(c, solved);
        if (walls_ && c.probes != nullptr) c.probes->friction(c.params, friction, solved);
    }

    static Left read(std::span<const std::byte> bytes, double tolerance) {
        const vec4* v = reinterpret_cast<const vec4*>(bytes.data());
        Left l{v[0].z, v[1].x, v[1].y, true, 0};
        // No more than `tolerance` of the velocities, nor of what viscosity changes; what single precision cannot say is never waited for.
        constexpr double kRounding = 1.0e-6;
        const double goal = tolerance * std::sqrt(std::min(double{l.start}, double{l.whole})) + kRounding * std::sqrt(double{l.whole});
        l.goal = goal * goal;
        return l;
    }

    bool walls_ = false, frictionWritten_ = false;
    int planned_ = 8;
    std::shared_ptr<Left> last_ = std::make_shared<Left>();
};

bool on(const FluidParams& p, bool doesViscosity) {
    if (!(p.viscosity > 0)) return false;
    if (doesViscosity) return p.collision.walls == "no-slip";
    if (p.forces.viscosity != "auto") return p.forces.viscosity != "none";
    // Within a second it evens out what lies less than a tenth of the support radius apart: that is not visible.
    const double h = double{p.supportSpacings} * double{p.spacing};
    return double{p.viscosity} > 0.01 * h * h;
}

Result<ForcePass> make(Device& device, const MethodSetup& setup) {
    auto v = std::make_shared<Viscosity>();
    v->doesViscosity = setup.doesViscosity;
    v->samples = setup.traits.matter && setup.traits.samples > 0;
    std::vector<Define> matter;
    if (setup.traits.matter) matter.push_back({"MATTER", "1"});
    struct Wanted {
        Kernel* kernel;
        const char* path;
        std::vector<Define> defines;
        bool wanted = true;
    };
    v->walled = setup.traits.walls;
    for (const Wanted& w :
         {Wanted{&v->drag, "fluid/forces/wall_drag", matter, v->walled}, Wanted{&v->guess, "fluid/forces/viscous_guess", matter},
          Wanted{&v->sum, "fluid/forces/viscous_sum", {}}, Wanted{&v->scalars, "fluid/forces/viscous_scalars", {}},
          Wanted{&v->update, "fluid/forces/viscous_update", {}}, Wanted{&v->finish, "fluid/forces/viscous_finish", {}}}) {
        if (!w.wanted) continue;
        Result<Kernel> found = device.kernel(w.path, w.defines);
        if (!found) return found.error();
        *w.kernel = *found;
    }
    struct WantedPair {
        PairKernel* kernel;
        const char* path;
        std::vector<Define> defines;
        bool wanted;
    };
    const Define samples{"SAMPLES", "1"}, begin{"START", "1"};
    for (const WantedPair& w : {WantedPair{&v->explicit_, "fluid/forces/viscosity", {}, true},
                                WantedPair{&v->onSamples, "fluid/forces/viscosity", {samples}, v->samples},
                                WantedPair{&v->start, "fluid/forces/viscous_sweep", {begin}, true},
                                WantedPair{&v->apply, "fluid/forces/viscous_sweep", {}, true}}) {
        if (!w.wanted) continue;
        Result<PairKernel> found = PairKernel::find(device, w.path, setup.traits, w.defines);
        if (!found) return found.error();
        *w.kernel = *found;
    }
    const size_t vectors = size_t{setup.count} * sizeof(vec4);
    for (auto [buffer, bytes] : {std::pair(&v->friction, vectors), std::pair(&v->solved, vectors), std::pair(&v->left, vectors),
                                 std::pair(&v->applied, vectors), std::pair(&v->direction, vectors), std::pair(&v->changed, vectors),
                                 std::pair(&v->rows, STATS_THREADS * sizeof(vec4)), std::pair(&v->result, 2 * sizeof(vec4))}) {
        Result<Buffer> made = device.allocate(bytes);
        if (!made) return made.error();
        *buffer = std::move(*made);
    }
    return ForcePass([v](StepContext& c) { v->run(c); });
}

// Explicit viscosity alone has a limit, that of the method's own pair forces included; an implicit solver has none.
StepLimit limit(const ForceLimitInputs& in) {
    const FluidParams& p = in.params;
    const double laminar = in.doesViscosity || p.forces.viscosity == "explicit" ? double{p.viscosity} : 0.0;
    const double nu = (laminar > 0 ? std::max(laminar, double{in.mostViscous}) : laminar) + 0.1 * double{in.artificial};
    if (!(nu > 0)) return {};
    const double hs = 0.5 * double{in.h};
    return {0.125 * hs * hs / nu, "viscosity"};
}

}  // namespace

void Params::visit(ParamVisitor& v) {
    static const std::vector<std::string> ways = {"auto", "explicit", "implicit", "none"};
    v.choice({.name = "viscosity",
              .doc = "viscosity of methods pbf and dfsph; explicit: one pass per substep, which is limited to 0.125 hs^2 / viscosity; "
                     "implicit: a solver, for any substep; auto: explicit if the substep is within that limit anyway, else implicit, and "
                     "none if viscosity acts over less than a tenth of the support radius in a second"},
             viscosity, ways);
    v.value({"viscosityTolerance", "",
             "error that the implicit solver may leave, as a share of the velocities and of their change by viscosity", 1.0e-5, 0.5, kLog},
            viscosityTolerance);
    v.value({"viscosityIterations", "", "limit on iterations of the implicit solver per substep", 1, 1000, kLog}, viscosityIterations);
}

ForceRow row() {
    return {.name = "viscosity",
            .doc = "viscosity of the fluid, explicit or implicit, and at no-slip walls",
            .order = 100,  // last: the implicit solver needs the sum of all other forces
            .remedy = "set fluid.forces.viscosity to none and fluid.collision.walls to slip",
            .on = on,
            .make = make,
            .limit = limit};
}

}  // namespace force_viscosity
}  // namespace rivulet
