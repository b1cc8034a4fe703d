#include "fluid/sim/fluid_world.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "fluid/sim/block.h"
#include "fluid/sim/force.h"
#include "fluid/sim/method.h"
#include "fluid/sim/neighbor_grid.h"
#include "fluid/sim/particles.h"
#include "fluid/sim/solid_passes.h"
#include "shaders/fluid/stats_row.h"

namespace rivulet {

namespace {

// Above this a device's memory is surely exceeded; said before anything is allocated.
constexpr double kMostParticles = 64.0e6;
// GPU figures come this many frames late at most: speeds may have grown by gravity since.
constexpr double kLateFrames = 3;

}  // namespace

struct FluidWorld::Impl {
    Device* device = nullptr;
    FluidParams params;
    Log log;
    std::unique_ptr<Method> method;
    std::unique_ptr<NeighborGrid> grid;
    Particles particles;
    std::vector<NewParticle> start;
    SolidPasses solids;
    Buffer statsRows, corner;
    Kernel stats, wrap, wrapFromPositions, gatherMatter;
    PairTraits traits;
    struct ForceState {
        const ForceRow* row;
        ForcePass pass;  // made when it is first on
        bool on = false;
    };
    std::vector<ForceState> forcePasses;
    SolveFigures solve;
    double iterations = 0;                                                 // of a frame, all substeps
    std::shared_ptr<FluidStats> figures = std::make_shared<FluidStats>();  // shared with reads that are still on their way
    StepParams step{};
    vec3 gravity{0.0F};
    double time = 0;
    uint64_t frame = 0;
    int lastSubsteps = 0;
    double dtMin = 0, dtMax = 0;
    float fastestWall = 0;  // m/s, of moving solids, lately

    Status prepare();
    void fillStart();
    void writeStart();
    float fastestFall() const;
    double stepLimit(double frameSeconds) const;
    void say(const std::string& sentence);
    void findForces();
    bool build(bool fromPositions, double from, double to);
    // `last`: of its frame.
    void substep(double dt, double from, double to, bool last);
    void gatherStats(int substeps);
};

FluidWorld::FluidWorld() : impl_(std::make_unique<Impl>()) {}
FluidWorld::~FluidWorld() = default;
const FluidParams& FluidWorld::params() const { return impl_->params; }
const FluidStats& FluidWorld::stats() const { return *impl_->figures; }
double FluidWorld::time() const { return impl_->time; }
int FluidWorld::lastSubsteps() const { return impl_->lastSubsteps; }
const std::vector<Pose>& FluidWorld::poses() const { return impl_->solids.poses(); }
uint64_t FluidWorld::voxelsRewritten() const { return impl_->solids.voxelsRewritten(); }
Device& FluidWorld::device() const { return *impl_->device; }

// The speed water of this scene reaches by falling from its highest block to the far side of the box, with what it starts with.
float FluidWorld::Impl::fastestFall() const {
    const float g = glm::length(gravity);
    float fastest = 0.0F;
    for (const BlockParams& b : params.blocks) {
        float fall = 0.0F;
        if (g > 0.0F) {
            const vec3 down = gravity / g;
            for (int k = 0; k < 3; ++k)
                fall += std::abs(down[k]) * (down[k] < 0 ? b.max[k] - params.box.min[k] : params.box.max[k] - b.min[k]);
        }
        fastest = std::max(fastest, std::sqrt(2.0F * g * std::max(fall, 0.0F)) + glm::length(b.velocity));
    }
    fastest = std::max(fastest, fastestWall);
    // Still water without gravity has no speed of its own: the length it could be pushed over in a tenth of a second.
    return std::max(fastest, 10.0F * params.spacing);
}

Status FluidWorld::Impl::prepare() {
    const MethodRow* row = methods().find(params.method);
    if (row == nullptr) return badInput(fmt::format("fluid.method '{}' is not known", params.method));
    const float h = params.supportSpacings * params.spacing;
    double wanted = 0;
    for (const BlockParams& b : params.blocks) wanted += blockCount(b, params.spacing);
    if (wanted > kMostParticles)
        return badInput(fmt::format(
            "fluid.blocks hold {:.3g} particles at a spacing of {} m, more than {:.0f} million: use a spacing of at least {:.3g} m", wanted,
            params.spacing, kMostParticles / 1e6, params.spacing * std::cbrt(wanted / kMostParticles)));
    fillStart();

    struct Wanted {
        Kernel* kernel;
        const char* path;
        std::vector<Define> defines;
        bool wanted;
    };
    const Define fromPositions{"FROM_POSITIONS", "1"};
    traits.periodic = params.box.periodic();
    for (const Wanted& w : {Wanted{&stats, "fluid/stats", {}, true}, Wanted{&wrap, "fluid/wrap", {}, glm::any(traits.periodic)},
                            Wanted{&wrapFromPositions, "fluid/wrap", {fromPositions}, glm::any(traits.periodic)},
                            Wanted{&gatherMatter, "fluid/gather_matter", {}, traits.matter}}) {
        if (!w.wanted) continue;
        Result<Kernel> found = device->kernel(w.path, w.defines);
        if (!found) return found.error();
        *w.kernel = *found;
    }
    const uint32_t count = static_cast<uint32_t>(start.size());
    Result<std::unique_ptr<Method>> made = row->make(*device, {params, count, traits});
    if (!made) return made.error();
    method = std::move(*made);
    for (const ForceRow& force : forces().rows) forcePasses.push_back({&force, nullptr});

    Result<NeighborGrid> newGrid = NeighborGrid::create(*device, Bounds{params.box.min, params.box.max}, h, count, traits);
    if (!newGrid) return newGrid.error();
    grid = std::make_unique<NeighborGrid>(std::move(*newGrid));
    if (glm::any(traits.periodic)) {
        Result<Buffer> low = device->allocate(sizeof(vec4));
        if (!low) return low.error();
        corner = std::move(*low);
        const vec4 value(params.box.min, 0.0F);
        device->write(corner, std::as_bytes(std::span(&value, 1)));
    }
    Result<Particles> newParticles = Particles::create(*device, count, traits.matter);
    if (!newParticles) return newParticles.error();
    particles = std::move(*newParticles);
    Result<Buffer> rows = device->allocate(STATS_THREADS * sizeof(StatsRow));
    if (!rows) return rows.error();
    statsRows = std::move(*rows);
    if (count == 0) log.notice("the scene has no particles");
    writeStart();
    return ok();
}

// The blocks' particles, without those that would be born inside or too near a mesh or behind a plane.
void FluidWorld::Impl::fillStart() {
    for (const BlockParams& b : params.blocks) fillBlock(b, params.spacing, start);
    const size_t left = std::erase_if(start, [&](const NewParticle& p) { return !solids.mayBeBorn(p.position, params.spacing); });
    if (left > 0) log.notice(fmt::format("{} particles of fluid.blocks would start inside or too near a solid: they were left out", left));
}

void FluidWorld::Impl::writeStart() {
    std::vector<vec4> position, velocity;
    std::vector<uint32_t> id;
    position.reserve(start.size());
    velocity.reserve(start.size());
    id.reserve(start.size());
    for (const NewParticle& p : start) {
        position.emplace_back(p.position, 1.0F);
        velocity.emplace_back(p.velocity, 0.0F);
        id.push_back(static_cast<uint32_t>(id.size()));
    }
    device->writeAll<vec4>(particles.positionNext, position);
    device->writeAll<vec4>(particles.velocityNext, velocity);
    device->writeAll<uint32_t>(particles.id, id);
    time = 0;
    frame = 0;
    dtMin = dtMax = 0;
    method->reset();
    figures = std::make_shared<FluidStats>();
    figures->particles = particles.count;
}

void FluidWorld::Impl::say(const std::string& sentence) {
    if (std::find(figures->limited.begin(), figures->limited.end(), sentence) != figures->limited.end()) return;
    figures->limited.push_back(sentence);
    log.notice(sentence);
}

// The largest stable step: acoustic CFL or how far the fastest may go, viscous and body-force limits (Monaghan 1992, with the constants of
// Morris et al. 1997).
double FluidWorld::Impl::stepLimit(double frameSeconds) const {
    const double hs = 0.5 * step.h, g = glm::length(gravity);
    const double c0 = method->soundSpeed(params, fastestFall());
    double fastest = std::max(figures->maxSpeed, double{solids.fastestWall()}) +
                     g * frameSeconds * (device->backend() == Backend::cpu ? 1 : kLateFrames);
    double dt = frameSeconds;
    if (c0 > 0) {
        dt = params.cfl * hs / (c0 + fastest);
    } else {
        const Method::StepLimit limit = method->stepLimit(params);
        dt = std::min({dt, limit.longest, double{limit.reach} * params.spacing / std::max(fastest, 1.0e-9)});
    }
    // Explicit viscosity alone has a limit; an implicit solver has none.
    const double nu = explicitViscosity(params, method->doesViscosity()) + 0.1 * double{step.artificial};
    if (nu > 0) dt = std::min(dt, 0.125 * hs * hs / nu);
    dt = std::min(dt, capillaryLimit(params));
    if (g > 0) dt = std::min(dt, 0.25 * std::sqrt(hs / g));
    return dt;
}

// Passes of what is on from now; one that cannot be made stays off, and is said.
void FluidWorld::Impl::findForces() {
    for (ForceState& f : forcePasses) {
        f.on = f.row->on(params, method->doesViscosity());
        if (!f.on || f.pass) continue;
        Result<ForcePass> made = f.row->make(*device, {params, particles.count, traits, method->doesViscosity()});
        if (made)
            f.pass = std::move(*made);
        else
            say(made.error().message);
        f.on = static_cast<bool>(made);
    }
}

bool FluidWorld::Impl::build(bool fromPositions, double from, double to) {
    if (glm::any(traits.periodic) && fromPositions)
        device->run(wrapFromPositions, step, {&corner, &particles.positionNext, &particles.velocityNext}, particles.count);
    if (Status built = grid->build(step, particles); !built) {
        say(built.error().message);
        return false;
    }
    if (traits.matter)
        device->run(gatherMatter, step, {&grid->cellStart(), &particles.id, &particles.matterOf, &particles.matter, &particles.pressure},
                    particles.count);
    if (Status moved = solids.advance(params, step, glm::length(gravity), from, to); !moved) say(moved.error().message);
    return true;
}

// `from`, `to`: the shares of the frame's time at which it begins and ends.
void FluidWorld::Impl::substep(double dt, double from, double to, bool last) {
    step.dt = static_cast<float>(dt);
    step.maxSpeed = static_cast<float>(params.spacing / dt);
    bool built = false;
    StepContext context{.device = *device,
                        .fluid = params,
                        .params = step,
                        .grid = *grid,
                        .particles = particles,
                        .solve = solve,
                        .build = [&](bool fromPositions) { return built = build(fromPositions, from, to); },
                        .pushSamples = [](const Buffer&, const Buffer&, float) {},
                        .planes = solids.planes(),
                        .boundary = [&](const Buffer& position) { solids.boundary(step, *grid, position, particles.boundary); },
                        .forces = {},
                        .wallFriction = [&](const Buffer& position, Buffer& into) { solids.friction(step, *grid, position, into); },
                        .wallAdhesion = [&](const StepParams& s) { solids.adhesion(s, *grid, particles); }};
    for (const ForceState& f : forcePasses) context.hasForces |= f.on;
    context.forces = [&] {
        for (const ForceState& f : forcePasses)
            if (f.on) f.pass(context);
    };
    method->step(context);
    iterations += solve.iterations;
    if (!built) return;
    solids.collide(step, *grid, particles);
    if (glm::any(traits.periodic)) device->run(wrap, step, {&corner, &particles.positionNext}, particles.count);
    if (last) method->measure(context);
}

void FluidWorld::step(const FluidInputs& inputs, double seconds) {
    Impl& w = *impl_;
    w.device->poll();
    if (!(seconds > 0)) return;
    ++w.frame;
    if (w.particles.count == 0) {
        w.time += seconds;
        return;
    }
    w.gravity = inputs.gravity;
    if (Status asked = w.solids.beginFrame(inputs.poses, inputs.shapes, seconds); !asked) w.say(asked.error().message);
    // Remembered for a while: the speed of sound should not jump from frame to frame, nor keep a jump of a slider for ever.
    constexpr double kForget = 0.5;  // s
    w.fastestWall = std::max(w.fastestWall * static_cast<float>(std::exp(-seconds / kForget)), w.solids.fastestWall());
    const FluidParams& p = w.params;
    StepParams& s = w.step;
    s = StepParams{};
    s.gravity = vec4(inputs.gravity, 0.0F);
    s.boxMin = vec4(p.box.min, 1.0F);
    s.boxMax = vec4(p.box.max, 0.0F);
    constexpr float kNoWall = 1.0e15F;  // m away
    for (int k = 0; k < 3; ++k)
        if (w.traits.periodic[k]) {
            s.boxMin[k] = -kNoWall;
            s.boxMax[k] = kNoWall;
        }
    s.count = w.particles.count;
    s.h = p.supportSpacings * p.spacing;
    s.invH = 1.0F / s.h;
    s.mass = p.restDensity * p.spacing * p.spacing * p.spacing;
    s.restDensity = p.restDensity;
    s.viscosity = p.viscosity;
    s.contact = 0.5F * p.spacing;
    s.restitution = p.box.restitution;
    s.friction = p.collision.friction;
    s.spacing = p.spacing;
    s.planeCount = w.solids.planeCount();
    w.grid->fill(s);
    w.method->fill(p, w.fastestFall(), s);

    w.findForces();
    const double limit = w.stepLimit(seconds);
    int substeps = static_cast<int>(std::min(std::ceil(seconds / limit - 1e-6), 1.0e9));
    substeps = std::max(substeps, 1);
    double dt = seconds / substeps;
    if (substeps > p.maxSubsteps) {
        substeps = p.maxSubsteps;
        dt = limit;
        w.say(fmt::format("a frame needed more than fluid.maxSubsteps = {} steps: simulated time runs slower than asked", p.maxSubsteps));
    }
    w.iterations = 0;
    for (int k = 0; k < substeps; ++k) w.substep(dt, k * dt / seconds, (k + 1) * dt / seconds, k + 1 == substeps);
    w.lastSubsteps = substeps;
    w.time += dt * substeps;
    w.dtMin = w.dtMin == 0 ? dt : std::min(w.dtMin, dt);
    w.dtMax = std::max(w.dtMax, dt);
    w.gatherStats(substeps);
}

void FluidWorld::Impl::gatherStats(int substeps) {
    device->run(stats, step, {&grid->cellStart(), &particles.positionNext, &particles.velocityNext, &statsRows}, STATS_THREADS);
    const FluidStats now{.frame = frame,
                         .time = time,
                         .particles = particles.count,
                         .substeps = substeps,
                         .iterations = iterations / substeps,
                         .residual = solve.residual,
                         .dtMin = dtMin,
                         .dtMax = dtMax,
                         .limited = {}};
    device->readLater(
        statsRows, STATS_THREADS * sizeof(StatsRow),
        [now, into = figures, mass = double{step.mass}, g = gravity, this](std::span<const std::byte> bytes) {
            const StatsRow* rows = reinterpret_cast<const StatsRow*>(bytes.data());
            FluidStats f = now;
            double centre[3] = {0, 0, 0}, inside = 0, compression = 0, speed2 = 0, limited = 0, nan = 0, lost = 0, fastest2 = 0;
            for (uint32_t k = 0; k < STATS_THREADS; ++k) {
                for (int axis = 0; axis < 3; ++axis) centre[axis] += double{rows[k].centre[axis]};
                inside += double{rows[k].centre.w};
                compression += double{rows[k].compression};
                speed2 += double{rows[k].speed2Sum};
                limited += double{rows[k].limited};
                nan += double{rows[k].nans};
                lost += double{rows[k].lost};
                f.maxCompression = std::max(f.maxCompression, double{rows[k].worst});
                fastest2 = std::max(fastest2, double{rows[k].speed2Max});
            }
            f.lost = static_cast<uint32_t>(lost);
            f.nan = static_cast<uint32_t>(nan);
            f.speedLimited = static_cast<uint32_t>(limited);
            f.maxSpeed = std::sqrt(fastest2);
            f.kinetic = 0.5 * mass * speed2;
            if (inside > 0) {
                f.avgCompression = compression / inside;
                for (int axis = 0; axis < 3; ++axis) {
                    f.centreOfMass[axis] = centre[axis] / inside;
                    f.potential -= mass * double{g[axis]} * centre[axis];
                }
            }
            f.limited = std::move(into->limited);
            *into = std::move(f);
            if (into != figures) return;  // the world was reset meanwhile
            if (into->lost > 0) say("particles left the grid or became NaN: they are frozen and counted as lost");
            if (into->speedLimited > 0) say("the fastest particles were slowed to one spacing a step");
        });
}

void FluidWorld::reset() {
    if (Status back = impl_->solids.reset(); !back) impl_->say(back.error().message);
    impl_->fastestWall = 0;
    impl_->writeStart();
}

void FluidWorld::setSurfaces(std::span<const Surface> surfaces) { impl_->solids.setSurfaces(surfaces); }

void FluidWorld::setParams(const FluidParams& params) {
    FluidParams next = params;
    // What sizes arrays or picks kernels stays as it was made.
    const FluidParams& old = impl_->params;
    next.method = old.method;
    next.kernel = old.kernel;
    next.spacing = old.spacing;
    next.supportSpacings = old.supportSpacings;
    next.box.min = old.box.min;
    next.box.max = old.box.max;
    next.box.periodicX = old.box.periodicX;
    next.box.periodicY = old.box.periodicY;
    next.box.periodicZ = old.box.periodicZ;
    next.blocks = old.blocks;
    next.collision.walk = old.collision.walk;
    impl_->params = next;
}

ParticleView FluidWorld::particles() const {
    const Impl& w = *impl_;
    return {&w.particles.positionNext,
            &w.particles.velocityNext,
            &w.particles.id,
            w.params.forces.normals != "none" && w.particles.normal ? &w.particles.normal : nullptr,
            w.particles.count,
            w.params.spacing,
            w.params.restDensity * w.params.spacing * w.params.spacing * w.params.spacing};
}

Result<std::unique_ptr<FluidWorld>> FluidWorld::create(Device& device, const FluidParams& params, const Solids& solids, Log log) {
    std::unique_ptr<FluidWorld> world(new FluidWorld());
    Impl& w = *world->impl_;
    w.device = &device;
    w.params = params;
    Result<SolidPasses> passes = SolidPasses::create(device, solids, params.collision);
    if (!passes) return passes.error();
    w.solids = std::move(*passes);
    w.log = std::move(log);
    w.gravity = params.gravity;
    if (Status s = w.prepare(); !s) return s.error();
    return world;
}

}  // namespace rivulet
