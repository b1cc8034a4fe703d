#include "fluid/sim/fluid_world.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "fluid/sim/block.h"
#include "fluid/sim/body_passes.h"
#include "fluid/sim/drawn_positions.h"
#include "fluid/sim/force.h"
#include "fluid/sim/liquids.h"
#include "fluid/sim/method.h"
#include "fluid/sim/neighbor_grid.h"
#include "fluid/sim/pace.h"
#include "fluid/sim/particles.h"
#include "fluid/sim/solid_passes.h"
#include "fluid/sim/source_passes.h"
#include "shaders/fluid/stats_row.h"

namespace rivulet {

namespace {

// Above this a device's memory is surely exceeded; said before anything is allocated.
constexpr double kMostParticles = 64.0e6;
// GPU figures come this many frames late at most: speeds may have grown by gravity since.
constexpr double kLateFrames = 3;

// The longest step that is stable, s, and what says so.
struct StepLimit {
    double dt;
    const char* why;
};

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
    Sources asked;  // emitters and sinks
    SourcePasses sources;
    uint32_t slots = 0;     // of particles: those of the blocks and room for more
    bool coloured = false;  // particles differ to the eye
    float mostViscous = 0;  // m^2/s, of the world's liquids
    BodyPasses bodies;
    Buffer statsRows, corner;
    Kernel stats, wrap, wrapFromPositions, gatherMatter, gatherAbsorption;
    PairTraits traits;
    struct ForceState {
        const ForceRow* row;
        ForcePass pass;  // made when it is first on
        bool on = false;
    };
    std::vector<ForceState> forcePasses;
    SolveFigures solve;
    double iterations = 0;  // of this frame's substeps, all of them
    Pace pace;
    DrawnPositions drawn;
    std::vector<Pose> posesBefore;                                         // the rigid solids', before the last fixed step
    std::shared_ptr<FluidStats> figures = std::make_shared<FluidStats>();  // shared with reads that are still on their way
    StepParams step{};
    vec3 gravity{0.0F};
    double time = 0, dropped = 0;
    double frameLength = 0;  // s, of the frame under way: what the substeps' shares are of
    uint64_t frame = 0;
    int lastSubsteps = 0;
    double dtMin = 0, dtMax = 0;
    float fastestWall = 0;  // m/s, of moving solids, lately
    bool budgetSaid = false;
    int lastPiece = 0;  // substeps

    Status prepare();
    void fillStart();
    Status findSlots();
    void findLiquids();
    void writeStart();
    void gatherColours();
    float fastestFall() const;
    StepLimit stepLimit(double frameSeconds) const;
    void fillStep();
    double stepPiece(double length, double begin, double span, int& substeps, bool& stop);
    void say(const std::string& sentence);
    void findForces();
    bool build(bool fromPositions, double from, double to);
    // `last`: of a piece of its frame.
    void substep(double dt, double from, double to, bool last);
    void gatherStats(int substeps, double until);
};

FluidWorld::FluidWorld() : impl_(std::make_unique<Impl>()) {}
FluidWorld::~FluidWorld() = default;
const FluidParams& FluidWorld::params() const { return impl_->params; }
const FluidStats& FluidWorld::stats() const { return *impl_->figures; }
double FluidWorld::time() const { return impl_->time; }
double FluidWorld::pending() const { return impl_->pace.pending(); }
double FluidWorld::dropped() const { return impl_->dropped; }
const dvec3& FluidWorld::origin() const { return impl_->params.origin; }
void FluidWorld::setOrigin(const dvec3& origin) { impl_->params.origin = origin; }
int FluidWorld::lastSubsteps() const { return impl_->lastSubsteps; }
const std::vector<Pose>& FluidWorld::poses() const { return impl_->solids.poses(); }
const std::vector<BodyState>& FluidWorld::bodies() const { return impl_->bodies.states(); }
const std::vector<BodyLoad>& FluidWorld::bodyLoads() const { return impl_->bodies.loads(); }
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
    for (const Emitter& e : asked.emitters) {
        float fall = 0.0F;
        for (int k = 0; k < 3; ++k)
            fall += std::abs(gravity[k]) *
                    (gravity[k] < 0 ? e.params.position[k] - params.box.min[k] : params.box.max[k] - e.params.position[k]);
        fastest = std::max(fastest, std::sqrt(2.0F * std::max(fall, 0.0F) + sources.fastest() * sources.fastest()));
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
    if (Status s = findSlots(); !s) return s;
    findLiquids();

    struct Wanted {
        Kernel* kernel;
        const char* path;
        std::vector<Define> defines;
        bool wanted;
    };
    const Define fromPositions{"FROM_POSITIONS", "1"};
    traits.periodic = params.box.periodic();
    traits.samples = bodies.sampleCount();
    traits.matter = traits.matter || bodies.any();
    for (const Wanted& w :
         {Wanted{&stats, "fluid/stats", traits.matter ? std::vector<Define>{{"MATTER", "1"}} : std::vector<Define>{}, true},
          Wanted{&wrap, "fluid/wrap", {}, glm::any(traits.periodic)},
          Wanted{&wrapFromPositions, "fluid/wrap", {fromPositions}, glm::any(traits.periodic)},
          Wanted{&gatherMatter, "fluid/gather_matter", {}, traits.matter},
          Wanted{&gatherAbsorption, "fluid/gather_absorption", {}, coloured}}) {
        if (!w.wanted) continue;
        Result<Kernel> found = device->kernel(w.path, w.defines);
        if (!found) return found.error();
        *w.kernel = *found;
    }
    const uint32_t count = slots + traits.samples;
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
    Result<Particles> newParticles = Particles::create(*device, count, traits.matter, coloured);
    if (!newParticles) return newParticles.error();
    particles = std::move(*newParticles);
    Result<Buffer> rows = device->allocate(STATS_THREADS * sizeof(StatsRow));
    if (!rows) return rows.error();
    statsRows = std::move(*rows);
    if (Status room = bodies.allocate(count); !room) return room.error();
    Result<SourcePasses> passes = SourcePasses::create(*device, asked, params, traits.matter, coloured);
    if (!passes) return passes.error();
    sources = std::move(*passes);
    if (count == 0) log.notice("the scene has no particles");
    writeStart();
    return ok();
}

// The blocks' particles, without those that would be born inside or too near a mesh or behind a plane.
void FluidWorld::Impl::fillStart() {
    for (size_t k = 0; k < params.blocks.size(); ++k) {
        const size_t first = start.size();
        fillBlock(params.blocks[k], params.spacing, start);
        for (size_t i = first; i < start.size(); ++i) start[i].block = static_cast<uint32_t>(k);
    }
    const size_t left = std::erase_if(start, [&](const NewParticle& p) {
        return !solids.mayBeBorn(p.position, params.spacing) || !bodies.mayBeBorn(p.position, params.spacing);
    });
    if (left > 0) log.notice(fmt::format("{} particles of fluid.blocks would start inside or too near a solid: they were left out", left));
}

// How many particles there is room for.
Status FluidWorld::Impl::findSlots() {
    const double held = static_cast<double>(start.size()), wanted = SourcePasses::slotsFor(asked, params);
    double room = held + wanted;
    if (params.maxParticles > 0) {
        room = params.maxParticles;
        if (room < held)
            return badInput(fmt::format("fluid.maxParticles is {}, but the blocks hold {} particles: raise it, or 0 makes room for all",
                                        params.maxParticles, start.size()));
    } else if (!asked.emitters.empty()) {
        room = std::min(room, kMostParticles);
        log.notice(fmt::format("room for {} particles: {} of the blocks, and what emitters let out in {} s, as far as the box holds it",
                               static_cast<uint64_t>(room), start.size(), asked.seconds));
    }
    slots = static_cast<uint32_t>(room);
    return ok();
}

// Whether particles differ, in what they are or in what they look like.
void FluidWorld::Impl::findLiquids() {
    std::vector<LiquidOf> all = {liquidOf(params, "")};
    const auto add = [&](const std::string& name, const vec3& dye, float amount) {
        if (liquids().find(name) == nullptr && !name.empty()) return;  // said when sources are made
        all.push_back(liquidOf(params, name));
        if (all.back().row != 0) traits.matter = coloured = true;
        if (dye != vec3(1.0F) && amount > 0) coloured = true;
    };
    for (const BlockParams& b : params.blocks) add(b.liquid, b.dye, b.dyeAmount);
    for (const Emitter& e : asked.emitters) add(e.params.liquid, e.params.dye, e.params.dyeAmount);
    // A pair has the harmonic mean of the two.
    mostViscous = 0;
    for (const LiquidOf& a : all)
        for (const LiquidOf& b : all)
            mostViscous =
                std::max(mostViscous, 2 * a.viscosity * b.viscosity / std::max((a.viscosity + b.viscosity) * a.density, 1.0e-30F));
}

void FluidWorld::Impl::writeStart() {
    std::vector<vec4> position, velocity;
    std::vector<uint32_t> id;
    position.reserve(particles.count);
    velocity.reserve(particles.count);
    id.reserve(particles.count);
    for (const NewParticle& p : start) {
        position.emplace_back(p.position, 1.0F);
        velocity.emplace_back(p.velocity, 0.0F);
        id.push_back(static_cast<uint32_t>(id.size()));
    }
    for (uint32_t k = static_cast<uint32_t>(start.size()); k < slots; ++k) {
        position.emplace_back(params.box.min, -1.0F);
        velocity.emplace_back(0.0F);
        id.push_back(k);
    }
    // Samples on bodies come last; each substep puts them where they are.
    for (uint32_t k = 0; k < traits.samples; ++k) {
        position.emplace_back(0.0F, 0.0F, 0.0F, -1.0F);
        velocity.emplace_back(0.0F);
        id.push_back(static_cast<uint32_t>(id.size()));
    }
    std::vector<vec4> matterOf, absorptionOf;
    for (const NewParticle& p : start) {
        const BlockParams& b = params.blocks[p.block];
        const LiquidOf liquid = liquidOf(params, b.liquid);
        if (traits.matter) matterOf.emplace_back(1.0F, params.restDensity / liquid.density, liquid.viscosity, liquid.row);
        if (coloured) absorptionOf.push_back(liquid.absorption + vec4(dyeAbsorption(b.dye, b.dyeAmount), 0.0F));
    }
    if (traits.matter) {
        matterOf.resize(slots, vec4(1.0F, 1.0F, params.viscosity * params.restDensity, 0.0F));
        const std::vector<vec4> samples = bodies.matter();
        matterOf.insert(matterOf.end(), samples.begin(), samples.end());
        device->writeAll<vec4>(particles.matterOf, matterOf);
    }
    if (coloured) device->writeAll<vec4>(particles.absorptionOf, absorptionOf);
    device->writeAll<vec4>(particles.positionNext, position);
    device->writeAll<vec4>(particles.velocityNext, velocity);
    device->writeAll<uint32_t>(particles.id, id);
    sources.reset();
    gatherColours();
    time = dropped = 0;
    frame = 0;
    dtMin = dtMax = 0;
    budgetSaid = false;
    pace.reset();
    drawn.forget();
    posesBefore.clear();
    for (const NamedBuffer& b : method->remembered()) device->fill(*b.buffer, 0);
    figures = std::make_shared<FluidStats>();
    figures->particles = static_cast<uint32_t>(start.size());
    figures->emitted = static_cast<double>(start.size()) * std::pow(double{params.spacing}, 3);
}

void FluidWorld::Impl::gatherColours() {
    if (!coloured) return;
    StepParams all{};
    all.count = particles.count;
    device->run(gatherAbsorption, all, {&particles.id, &particles.absorptionOf, &particles.absorption}, particles.count);
}

void FluidWorld::Impl::say(const std::string& sentence) {
    if (std::find(figures->limited.begin(), figures->limited.end(), sentence) != figures->limited.end()) return;
    figures->limited.push_back(sentence);
    log.notice(sentence);
}

// The largest stable step: acoustic CFL or how far the fastest may go, viscous and body-force limits (Monaghan 1992, with the constants of
// Morris et al. 1997).
StepLimit FluidWorld::Impl::stepLimit(double frameSeconds) const {
    const double hs = 0.5 * step.h, g = glm::length(gravity);
    const double c0 = method->soundSpeed(params, fastestFall());
    double fastest = std::max({figures->maxSpeed, double{solids.fastestWall()}, double{sources.fastest()}, double{bodies.fastest()}}) +
                     g * frameSeconds * (device->backend() == Backend::cpu ? 1 : kLateFrames);
    StepLimit limit{frameSeconds, "the frame"};
    const auto atMost = [&limit](double dt, const char* why) {
        if (dt < limit.dt) limit = {dt, why};
    };
    const Method::StepLimit own = method->stepLimit(params);
    if (c0 > 0) atMost(params.cfl * hs / (c0 + fastest), "the speed of sound (fluid.cfl)");
    atMost(double{own.reach} * params.spacing / std::max(fastest, 1.0e-9), "the speed of the fastest particle or wall");
    atMost(own.longest, "the method's fewest steps a frame (minSubsteps)");
    // Explicit viscosity alone has a limit; an implicit solver has none.
    const double laminar = explicitViscosity(params, method->doesViscosity());
    const double nu = (laminar > 0 && traits.matter ? std::max(laminar, double{mostViscous}) : laminar) + 0.1 * double{step.artificial};
    if (nu > 0) atMost(0.125 * hs * hs / nu, "viscosity");
    atMost(capillaryLimit(params), "surface tension");
    if (g > 0) atMost(0.25 * std::sqrt(hs / g), "gravity");
    return limit;
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
    bodies.place(step, particles);
    if (Status built = grid->build(step, particles); !built) {
        say(built.error().message);
        return false;
    }
    if (traits.matter)
        device->run(gatherMatter, step, {&grid->cellStart(), &particles.id, &particles.matterOf, &particles.matter, &particles.pressure},
                    particles.count);
    bodies.index(step, *grid, particles);
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
                        .pushSamples = [&](const Buffer& position, const Buffer& pressures,
                                           float scale) { bodies.push(step, *grid, particles, position, pressures, scale); },
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
    bodies.advance(step, particles, dt);
    sources.run(step, params, *grid, particles, solids, time + to * frameLength, dt, last);
}

double FluidWorld::taken(double seconds) {
    Impl& w = *impl_;
    if (!(seconds > 0)) return 0;
    const double most = w.params.longestFrame;
    if (seconds <= most) return seconds;
    w.dropped += seconds - most;
    w.say(fmt::format("a frame was longer than fluid.longestFrame = {} s: what was beyond it has been dropped", w.params.longestFrame));
    return most;
}

void FluidWorld::step(const FluidInputs& inputs, double seconds) {
    Impl& w = *impl_;
    w.device->poll();
    if (!(seconds > 0)) return;
    const double now = taken(seconds);
    ++w.frame;
    if (w.particles.count == 0) {
        w.time += now;
        return;
    }
    const FluidParams& p = w.params;
    const bool cpu = w.device->backend() == Backend::cpu;
    if (!cpu) w.pace.know(inputs.deviceMs, w.lastSubsteps);
    const Pace::Frame frame = w.pace.begin(now, double{p.fixedStep}, double{p.frameBudget});
    const double span = frame.before + seconds;  // until the solids are where they are to be
    w.frameLength = span;
    w.gravity = inputs.gravity;
    if (Status asked = w.solids.beginFrame(inputs.poses, inputs.shapes, span); !asked) w.say(asked.error().message);
    // Remembered for a while: the speed of sound should not jump from frame to frame, nor keep a jump of a slider for ever.
    constexpr double kForget = 0.5;  // s
    w.fastestWall = std::max(w.fastestWall * static_cast<float>(std::exp(-now / kForget)), w.solids.fastestWall());
    w.findForces();
    w.iterations = 0;
    double stepped = 0;
    int substeps = 0, done = 0;
    bool stop = false;
    while (done < frame.pieces && !stop) {
        if (p.fixedStep > 0) {
            if (Status ready = w.drawn.prepare(*w.device, w.particles.count); !ready) w.say(ready.error().message);
            w.drawn.remember(*w.device, w.particles);
            w.posesBefore = w.solids.poses();
        }
        stepped += w.stepPiece(frame.length, stepped, span, substeps, stop);
        ++done;
        if (done == frame.pieces || stop) break;
        if (p.fixedStep > 0)
            stop = !(cpu ? w.pace.mayGoOn(done) : w.pace.mayPlan(substeps + w.lastPiece - 1));
        else
            stop = !(cpu ? w.pace.mayGoOn(substeps) : w.pace.mayPlan(substeps));
    }
    w.lastSubsteps = substeps;
    w.time += stepped;
    w.gatherColours();
    const double lost = w.pace.end(stepped);
    // What rounding leaves of a whole frame is no loss.
    if (lost > 1.0e-9 * seconds) {
        w.dropped += lost;
        if (substeps < p.maxSubsteps && p.frameBudget > 0 && !w.budgetSaid) {
            w.budgetSaid = true;
            w.say(
                fmt::format("a frame's steps take longer than fluid.frameBudget = {} ms, their length limited by {}: simulated time runs "
                            "slower than asked",
                            p.frameBudget, w.stepLimit(frame.length).why));
        }
    }
    if (p.fixedStep > 0)
        w.drawn.draw(*w.device, w.particles, w.pace.share(), static_cast<float>(std::max(w.lastPiece, 1) + 1) * p.spacing);
    else
        w.drawn.forget();
}

// What a step knows beside its length.
void FluidWorld::Impl::fillStep() {
    const FluidParams& p = params;
    step = StepParams{};
    step.gravity = vec4(gravity, 0.0F);
    step.boxMin = vec4(p.box.min, 1.0F);
    step.boxMax = vec4(p.box.max, 0.0F);
    constexpr float kNoWall = 1.0e15F;  // m away
    for (int k = 0; k < 3; ++k)
        if (traits.periodic[k]) {
            step.boxMin[k] = -kNoWall;
            step.boxMax[k] = kNoWall;
        }
    step.count = particles.count;
    step.h = p.supportSpacings * p.spacing;
    step.invH = 1.0F / step.h;
    step.mass = p.restDensity * p.spacing * p.spacing * p.spacing;
    step.restDensity = p.restDensity;
    step.viscosity = p.viscosity;
    step.contact = 0.5F * p.spacing;
    step.restitution = p.box.restitution;
    step.friction = p.collision.friction;
    step.spacing = p.spacing;
    step.planeCount = solids.planeCount();
    grid->fill(step);
    method->fill(p, fastestFall(), step);
}

// Steps `length` s on, from `begin` s after the start of a frame whose solids need `span` s for their way. Returns how far it came:
// less where maxSubsteps or the budget end it, and then nothing more of the frame is to be stepped.
double FluidWorld::Impl::stepPiece(double length, double begin, double span, int& substeps, bool& stop) {
    fillStep();
    const StepLimit limit = stepLimit(length);
    int count = static_cast<int>(std::min(std::ceil(length / limit.dt - 1e-6), 1.0e9));
    count = std::max(count, 1);
    double dt = length / count;
    if (substeps + count > params.maxSubsteps) {
        count = params.maxSubsteps - substeps;
        dt = limit.dt;
        stop = true;
        say(
            fmt::format("a frame needed more than fluid.maxSubsteps = {} steps, their length limited by {}: simulated time runs slower "
                        "than asked",
                        params.maxSubsteps, limit.why));
    }
    const bool cpu = device->backend() == Backend::cpu;
    int done = 0;
    while (done < count) {
        substep(dt, (begin + done * dt) / span, (begin + (done + 1) * dt) / span, done + 1 == count);
        ++done;
        ++substeps;
        // A fixed step is not left half done.
        if (!(params.fixedStep > 0) && done < count && !(cpu ? pace.mayGoOn(substeps) : pace.mayPlan(substeps))) {
            stop = true;
            break;
        }
    }
    if (done == 0) return 0;
    lastPiece = done;
    dtMin = dtMin == 0 ? dt : std::min(dtMin, dt);
    dtMax = std::max(dtMax, dt);
    sources.report();
    gatherStats(substeps, time + begin + dt * done);
    return dt * done;
}

void FluidWorld::Impl::gatherStats(int substeps, double until) {
    std::vector<const Buffer*> buffers = {&grid->cellStart(), &particles.positionNext, &particles.velocityNext, &statsRows};
    if (traits.matter) buffers.insert(buffers.end(), {&particles.id, &particles.matterOf});
    device->dispatch(stats, std::as_bytes(std::span(&step, 1)), buffers, STATS_THREADS);
    const FluidStats now{.frame = frame,
                         .time = until,
                         .particles = particles.count,
                         .substeps = substeps,
                         .iterations = iterations / substeps,
                         .residual = solve.residual,
                         .dtMin = dtMin,
                         .dtMax = dtMax,
                         .limited = {}};
    device->readLater(
        statsRows, STATS_THREADS * sizeof(StatsRow),
        [now, into = figures, count = start.size(), volume = std::pow(double{params.spacing}, 3), mass = double{step.mass}, g = gravity,
         this](std::span<const std::byte> bytes) {
            const StatsRow* rows = reinterpret_cast<const StatsRow*>(bytes.data());
            FluidStats f = now;
            double centre[3] = {0, 0, 0}, inside = 0, masses = 0, compression = 0, speed2 = 0, limited = 0, nan = 0, lost = 0, fastest2 = 0;
            for (uint32_t k = 0; k < STATS_THREADS; ++k) {
                for (int axis = 0; axis < 3; ++axis) centre[axis] += double{rows[k].centre[axis]};
                masses += double{rows[k].centre.w};
                inside += double{rows[k].inside};
                compression += double{rows[k].compression};
                speed2 += double{rows[k].speed2Sum};
                limited += double{rows[k].limited};
                nan += double{rows[k].nans};
                lost += double{rows[k].lost};
                f.maxCompression = std::max(f.maxCompression, double{rows[k].worst});
                fastest2 = std::max(fastest2, double{rows[k].speed2Max});
            }
            f.particles = static_cast<uint32_t>(inside + lost);
            f.lost = static_cast<uint32_t>(lost);
            f.nan = static_cast<uint32_t>(nan);
            f.speedLimited = static_cast<uint32_t>(limited);
            f.maxSpeed = std::sqrt(fastest2);
            f.kinetic = 0.5 * mass * speed2;
            if (inside > 0) {
                f.avgCompression = compression / inside;
                for (int axis = 0; axis < 3; ++axis) {
                    f.centreOfMass[axis] = centre[axis] / masses;
                    f.potential -= mass * double{g[axis]} * centre[axis];
                }
            }
            f.limited = std::move(into->limited);
            const bool current = into == figures;  // else the world was reset meanwhile
            if (current) {
                f.emitted = (static_cast<double>(count) + static_cast<double>(sources.given())) * volume;
                f.drained = static_cast<double>(sources.drained()) * volume;
                f.owed = sources.owed() * volume;
            }
            *into = std::move(f);
            if (!current) return;
            if (sources.full())
                say(fmt::format(
                    "there is room for no more than {} particles: emitters wait for free slots; fluid.maxParticles says how many", slots));
            if (into->lost > 0) say("particles left the grid or became NaN: they are frozen and counted as lost");
            if (into->speedLimited > 0) say("the fastest particles were slowed to one spacing a step");
        });
}

void FluidWorld::reset() {
    if (Status back = impl_->solids.reset(); !back) impl_->say(back.error().message);
    impl_->bodies.reset();
    impl_->fastestWall = 0;
    impl_->writeStart();
}

void FluidWorld::setSurfaces(std::span<const Surface> surfaces) { impl_->solids.setSurfaces(surfaces); }

void FluidWorld::setSources(const Sources& next) {
    Impl& w = *impl_;
    if (Status s = w.sources.set(next); !s) return w.say(s.error().message);
    for (size_t k = 0; k < next.emitters.size(); ++k) w.asked.emitters[k].params = next.emitters[k].params;
}

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
    next.liquid = old.liquid;
    next.maxParticles = old.maxParticles;
    if (Status s = takeLiquid(next); !s) return impl_->say(s.error().message);
    if (impl_->traits.matter) {  // particles have theirs for life
        next.restDensity = old.restDensity;
        next.viscosity = old.viscosity;
    }
    next.collision.walk = old.collision.walk;
    // A scene gives the origin in floats: it says nothing new of a double that rounds to them.
    if (vec3(next.origin) == vec3(old.origin)) next.origin = old.origin;
    impl_->params = next;
}

std::vector<Pose> FluidWorld::drawnPoses() const {
    const Impl& w = *impl_;
    std::vector<Pose> poses = w.solids.poses();
    if (w.params.fixedStep > 0 && w.posesBefore.size() == poses.size())
        for (size_t k = 0; k < poses.size(); ++k) poses[k] = between(w.posesBefore[k], poses[k], double{w.pace.share()});
    return poses;
}

Status FluidWorld::savable() const {
    if (impl_->sources.any()) return failed("a scene with emitters or sinks cannot be saved or resumed: run it from its start");
    if (impl_->bodies.any()) return failed("a scene with bodies cannot be saved or resumed: run it from its start");
    return ok();
}

void FluidWorld::save(WorldState& state) {
    Impl& w = *impl_;
    w.device->finish();
    w.device->poll();
    state.putText("world.params", fixedValues([&w](ParamVisitor& v) { w.params.visit(v); }));
    const FluidStats& f = *w.figures;
    const double numbers[] = {w.time,
                              w.pace.pending(),
                              w.dropped,
                              w.dtMin,
                              w.dtMax,
                              f.maxSpeed,
                              w.fastestWall,
                              static_cast<double>(w.frame),
                              w.params.origin.x,
                              w.params.origin.y,
                              w.params.origin.z};
    state.put<double>("world.numbers", numbers);
    state.putText("world.limited", fmt::format("{}", fmt::join(f.limited, "\n")));
    w.particles.save(*w.device, state);
    for (const NamedBuffer& b : w.method->remembered())
        state.put<float>(fmt::format("method.{}", b.name), w.device->readAll<float>(*b.buffer, b.buffer->bytes() / sizeof(float)));
    w.solids.save(state);
}

Status FluidWorld::restore(WorldState& state) {
    Impl& w = *impl_;
    if (Status can = savable(); !can) return can;
    // All of it is taken and judged before anything changes.
    Result<std::string> params = state.takeText("world.params");
    if (!params) return params.error();
    if (Status same = sameFixedValues(*params, fixedValues([&w](ParamVisitor& v) { w.params.visit(v); })); !same) return same;
    Result<std::vector<double>> numbers = state.take<double>("world.numbers", 11);
    if (!numbers) return numbers.error();
    const std::vector<double>& n = *numbers;
    if (std::any_of(n.begin(), n.end(), [](double v) { return !std::isfinite(v); }) ||
        std::any_of(n.begin(), n.begin() + 8, [](double v) { return v < 0; }))
        return badInput("the saved state's numbers make no sense: save it again");
    Result<std::string> limited = state.takeText("world.limited");
    if (!limited) return limited.error();
    Result<Particles::Saved> saved = w.particles.take(state);
    if (!saved) return saved.error();
    const std::vector<NamedBuffer> remembered = w.method->remembered();
    std::vector<std::vector<float>> memory;
    for (const NamedBuffer& b : remembered) {
        Result<std::vector<float>> values = state.take<float>(fmt::format("method.{}", b.name), b.buffer->bytes() / sizeof(float));
        if (!values) return values.error();
        memory.push_back(std::move(*values));
    }
    Result<SolidPasses::Places> places = w.solids.take(state);
    if (!places) return places.error();
    if (Status all = state.allTaken(); !all) return all;

    w.writeStart();
    w.particles.restore(*w.device, *saved);
    for (size_t k = 0; k < remembered.size(); ++k) w.device->writeAll<float>(*remembered[k].buffer, memory[k]);
    w.time = n[0];
    w.pace.reset(n[1]);
    w.dropped = n[2];
    w.dtMin = n[3];
    w.dtMax = n[4];
    w.figures->maxSpeed = n[5];
    w.fastestWall = static_cast<float>(n[6]);
    w.frame = static_cast<uint64_t>(n[7]);
    w.params.origin = dvec3(n[8], n[9], n[10]);
    w.figures->frame = w.frame;
    w.figures->time = w.time;
    for (size_t at = 0; at < limited->size();) {
        const size_t end = std::min(limited->find('\n', at), limited->size());
        w.figures->limited.push_back(limited->substr(at, end - at));
        at = end + 1;
    }
    return w.solids.restore(*places);
}

ParticleView FluidWorld::particles() const {
    const Impl& w = *impl_;
    return {.position = &w.particles.positionNext,
            .velocity = &w.particles.velocityNext,
            .id = &w.particles.id,
            .normal = w.params.forces.normals != "none" && w.particles.normal ? &w.particles.normal : nullptr,
            .count = w.slots,
            .slots = w.particles.count,
            .absorption = w.coloured ? &w.particles.absorption : nullptr,
            .matterOf = w.traits.matter ? &w.particles.matterOf : nullptr,
            .spacing = w.params.spacing,
            .mass = w.params.restDensity * w.params.spacing * w.params.spacing * w.params.spacing,
            .drawn = &w.drawn.positions(w.particles)};
}

Result<std::unique_ptr<FluidWorld>> FluidWorld::create(Device& device, const FluidParams& params, const Solids& solids, Log log,
                                                       const Sources& sources) {
    std::unique_ptr<FluidWorld> world(new FluidWorld());
    Impl& w = *world->impl_;
    w.device = &device;
    w.params = params;
    w.asked = sources;
    if (Status s = takeLiquid(w.params); !s) return s.error();
    Result<SolidPasses> passes = SolidPasses::create(device, solids, params.collision);
    if (!passes) return passes.error();
    w.solids = std::move(*passes);
    Result<BodyPasses> bodies = BodyPasses::create(device, solids.bodies, solids.bodyHost, params, {.periodic = params.box.periodic()});
    if (!bodies) return bodies.error();
    w.bodies = std::move(*bodies);
    w.log = std::move(log);
    w.gravity = params.gravity;
    if (Status s = w.prepare(); !s) return s.error();
    return world;
}

}  // namespace rivulet
