#include "fluid/sim/world/fluid_world.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <new>
#include <utility>

#include "engine/core/assert.h"
#include "engine/core/json.h"
#include "engine/core/param_check.h"
#include "engine/core/param_fixed.h"
#include "fluid/sim/sources/attributes.h"
#include "fluid/sim/sources/liquids.h"
#include "fluid/sim/world/fluid_world_impl.h"

namespace rivulet {

FluidWorld::FluidWorld() : impl_(std::make_unique<Impl>()) {}
FluidWorld::~FluidWorld() = default;
const FluidParams& FluidWorld::params() const { return impl_->params; }
std::vector<float> FluidWorld::pressures() const { return impl_->method->pressures(*impl_->device, impl_->particles, impl_->step); }
const FluidStats& FluidWorld::stats() const {
    impl_->figures->bodyWaits = impl_->bodies.waits();  // with those of bodies(), which come after a step
    return *impl_->figures;
}
float FluidWorld::fastestFall() const { return impl_->fastestFall(); }
double FluidWorld::time() const { return impl_->clock.time; }
double FluidWorld::pending() const { return impl_->stepper.pending(); }
double FluidWorld::dropped() const { return impl_->clock.dropped; }
const dvec3& FluidWorld::origin() const { return impl_->params.origin; }
void FluidWorld::setOrigin(const dvec3& origin) { impl_->params.origin = origin; }
int FluidWorld::lastSubsteps() const { return impl_->clock.lastSubsteps; }
const std::vector<Pose>& FluidWorld::poses() const { return impl_->solids.poses(); }
const std::vector<BodyState>& FluidWorld::bodies() const {
    impl_->bodies.settle();
    return impl_->bodies.states();
}
const std::vector<BodyState>& FluidWorld::expectedBodies() const { return impl_->bodies.states(); }
std::optional<std::vector<BodyState>> FluidWorld::bodiesAt(double time) const {
    const BodyPasses& all = impl_->bodies;
    if (time == impl_->clock.time && !all.isAhead()) return all.states();
    return all.statesAt(time);
}
BodyRows FluidWorld::bodyRows() const { return impl_->bodies.rows(); }
const std::vector<BodyLoad>& FluidWorld::bodyLoads() const {
    impl_->bodies.settle();
    return impl_->bodies.loads();
}
const std::vector<uint32_t>& FluidWorld::bodyIds() const { return impl_->bodies.ids(); }
uint64_t FluidWorld::voxelsRewritten() const { return impl_->solids.voxelsRewritten(); }
Device& FluidWorld::device() const { return *impl_->device; }

void FluidWorld::Impl::gatherForDrawing() {
    StepParams all{};
    all.count = particles.count;
    if (coloured) device->run(gatherVectors, all, {&particles.id, &particles.absorptionOf, &particles.absorption}, particles.count);
    for (size_t k = 0; k < particles.attributes.size(); ++k)
        device->run(gatherVectors, all, {&particles.id, &particles.attributesOf[k], &particles.attributes[k]}, particles.count);
}

void FluidWorld::Impl::report(const std::string& sentence) {
    if (std::find(figures->limited.begin(), figures->limited.end(), sentence) != figures->limited.end()) return;
    figures->limited.push_back(sentence);
    log.notice(sentence);
}

// Reports settings that are known to fail.
void FluidWorld::Impl::warn() {
    if (!params.limits) report("fluid.limits is off: steps have the requested length and may be unstable");
    const vec3 reach = glm::max(glm::abs(params.box.min), glm::abs(params.box.max));
    const float most = std::max({reach.x, reach.y, reach.z}), apart = std::nextafter(most, 2.0F * most) - most;
    if (apart > 2.0e-3F * params.spacing)
        report(
            fmt::format("fluid.box is so far from (0, 0, 0) that positions there are rounded to {:.2g} m and slow motion is lost: set "
                        "fluid.origin to its position",
                        apart));
    const float support = params.supportSpacings, neighbours = 4.18879F * support * support * support;
    if (params.kernel == "cubic_spline" && neighbours > 55.0F)
        report(fmt::format(
            "fluid.supportSpacings = {} gives particles {:.0f} neighbours: with more than 55, particles with the cubic spline form pairs",
            support, neighbours));
}

StepLimits::Inputs FluidWorld::Impl::limitInputs() const {
    return {params,
            *method,
            forces,
            sourceSetup.emitters,
            gravity,
            sources.fastest(),
            bodies.fastest(),
            clock.time == 0,
            placed ? &*placed : nullptr};
}

StepLimit FluidWorld::Impl::stepLimit(double now, double frameSeconds) const {
    return limits.longest(limitInputs(),
                          {.late = std::max(now - figures->time, 0.0),
                           .maxSpeed = figures->maxSpeed,
                           .fastestWall = solids.fastestWall(),
                           .mostViscous = traits.matter ? mostViscous : 0.0F,
                           .step = step},
                          frameSeconds);
}

std::vector<ProbeFrame> FluidWorld::takeLoads() { return impl_->probes ? impl_->probes->take() : std::vector<ProbeFrame>{}; }

bool FluidWorld::hasCellWork() const {
    const Impl& w = *impl_;
    return w.device->backend() != Backend::cpu && !w.around && !w.traits.linked && !w.traits.sleeps && w.traits.samples == 0 &&
           !glm::any(w.traits.periodic) && !w.method->predicts();
}

std::optional<FluidWorld::CellWork> FluidWorld::cellWork() {
    Impl& w = *impl_;
    if (!w.sorted || !hasCellWork()) return std::nullopt;
    w.cellsValid = true;
    return CellWork{w.step, &w.particles.positionNext, &w.particles.id};
}

void FluidWorld::Impl::invalidateCells() {
    cellsValid = sortedForQuery = false;
    if (!grid) return;
    grid->setCells({});
    grid->sortAsleep();
}

void FluidWorld::setCells(std::span<const uint32_t> cells) {
    if (impl_->cellsValid) impl_->grid->setCells(cells);
}

void FluidWorld::reset() {
    Impl& w = *impl_;
    w.change();
    w.device->goOn();
    w.last = ok();
    w.changing = true;
    try {
        if (Status back = w.solids.reset(); !back) {
            w.report(back.error().message);
            if (back.error().memory) return;
        }
        w.bodies.reset();
        w.limits.fastestWall = 0;
        w.writeStart(w.insideAdded());
    } catch (const std::bad_alloc&) {
        return;  // lastStep() says so
    }
    w.changing = false;
    w.interrupted = w.device->interrupted();
}

void FluidWorld::deposit(const vec3& place, const vec3& velocity, double volume) {
    impl_->sources.deposit(place, velocity, volume);
    if (impl_->sleep) impl_->disturbAround({place, place});
    impl_->figures->pendingVolume = impl_->sources.pending() * std::pow(double{impl_->params.spacing}, 3);
}

std::vector<WorldParticle> FluidWorld::within(const Bounds& box, float faster, float looser) {
    ASSERT(impl_->exchange.any(), "an exchange of water needs Sources::expectedDeposit > 0");
    return impl_->exchange.within(impl_->step, impl_->particles, box, faster, looser);
}

void FluidWorld::withdraw(std::span<const uint32_t> slots) {
    Impl& w = *impl_;
    ASSERT(w.exchange.any(), "an exchange of water needs Sources::expectedDeposit > 0");
    if (slots.empty()) return;
    w.change();
    w.invalidateCells();
    const std::vector<NamedBuffer> remembered = w.method->remembered();
    w.exchange.take(w.step, *w.grid, w.particles, remembered, slots, w.sorted);
    *w.withdrawn += slots.size();
    if (w.sleep) {
        w.disturbAround(w.exchange.taken(slots.size()));
        w.sleep->slotsChange();
    }
    w.grid->sortAsleep();
    w.figures->withdrawn = static_cast<double>(*w.withdrawn) * std::pow(double{w.params.spacing}, 3);
}

void FluidWorld::withinLater(const Bounds& box, float faster, float looser, std::function<void(std::span<const WorldParticle>)> then) {
    ASSERT(impl_->exchange.any(), "an exchange of water needs Sources::expectedDeposit > 0");
    impl_->exchange.withinLater(impl_->step, impl_->particles, box, faster, looser, std::move(then));
}

void FluidWorld::withdrawLater(std::span<const ParticleClaim> claims, std::function<void(std::span<const uint32_t>)> then) {
    Impl& w = *impl_;
    ASSERT(w.exchange.any(), "an exchange of water needs Sources::expectedDeposit > 0");
    if (claims.empty()) {
        then({});
        return;
    }
    w.change();
    w.invalidateCells();
    const std::vector<NamedBuffer> remembered = w.method->remembered();
    w.exchange.claim(w.step, *w.grid, w.particles, remembered, claims, w.sorted,
                     [all = w.withdrawn, figures = std::weak_ptr(w.figures), volume = std::pow(double{w.params.spacing}, 3),
                      then = std::move(then)](std::span<const uint32_t> removed) {
                         for (const uint32_t one : removed) *all += one;
                         if (const auto f = figures.lock()) f->withdrawn = static_cast<double>(*all) * volume;
                         then(removed);
                     });
    if (w.sleep) {
        Bounds around;
        for (const ParticleClaim& c : claims) {
            around.add(c.position - c.within);
            around.add(c.position + c.within);
        }
        w.disturbAround(around);
        w.sleep->slotsChange();
    }
    w.grid->sortAsleep();
}

Status FluidWorld::setSurfaces(std::span<const Surface> surfaces) {
    impl_->change();
    // A session sets them again whenever a slider moves, of the look too.
    if (impl_->solids.hasSurfaces(surfaces)) return ok();
    if (Status set = impl_->solids.setSurfaces(surfaces); !set) return set;
    if (impl_->sleep) impl_->sleep->disturbAll(impl_->clock.time);
    return ok();
}

Status FluidWorld::setSources(const Sources& next) {
    impl_->change();
    Impl& w = *impl_;
    if (!next.dry.empty() && w.traits.linked)
        return badInput("fluid.grid linked_list does not support dry volumes: choose fluid.grid sorted");
    if (Status s = checkDry(next.dry, w.bodies.ids()); !s) return s;
    if (!next.dry.empty())
        if (Status s = w.dry.prepare(*w.device, next.dry); !s) return s;
    std::vector<EmitterParams> emitters;
    emitters.reserve(next.emitters.size());
    for (const Emitter& e : next.emitters) emitters.push_back(e.params);
    std::vector<SinkParams> sinks = next.sinks;
    if (next.emitters.size() != w.sourceSetup.emitters.size() || sinks.size() != w.sourceSetup.sinks.size()) {
        if (Status s = w.replaceSources(next); !s) return s;
        w.setDry(next.dry);
        return ok();
    }
    if (Status s = w.sources.set(next); !s) return s;
    for (size_t k = 0; k < emitters.size(); ++k) w.sourceSetup.emitters[k].params = std::move(emitters[k]);
    w.sourceSetup.sinks = std::move(sinks);
    w.setDry(next.dry);
    return ok();
}

const std::vector<DryVolume>& FluidWorld::dry() const {
    if (impl_->dry.anyCarried() && impl_->bodies.rows().current) {
        impl_->bodies.settle();
        impl_->dry.place(impl_->bodies.states());
    }
    return impl_->dry.volumes();
}

std::vector<DryVolume> FluidWorld::ownDry() const { return impl_->dry.own(); }

Status FluidWorld::Impl::prepareProbes(const FluidParams& next) {
    std::optional<ProbePasses> made;
    if (!next.probes.empty()) {
        Result<ProbePasses> passes = ProbePasses::create(*device, next, probeTargets, {solids, bodies, particles, *grid, traits});
        if (!passes) return passes.error();
        made.emplace(std::move(*passes));
    }
    probes.reset();  // with its reads in flight
    figures->loads = {};
    if (made) probes.emplace(std::move(*made));
    return ok();
}

Status FluidWorld::setParams(const FluidParams& params) {
    impl_->change();
    if (Status s = checkParams("fluid", params); !s) return s;
    FluidParams next = params;
    const FluidParams& old = impl_->params;
    keepFixed(next, old);
    if (Status s = takeLiquid(next); !s) return s;
    if (impl_->traits.matter) {  // particles keep the liquid they were spawned with
        next.restDensity = old.restDensity;
        next.viscosity = old.viscosity;
    }
    // A scene gives the origin in floats: a double that rounds to them stays.
    if (vec3(next.origin) == vec3(old.origin)) next.origin = old.origin;
    const auto text = [](FluidParams p) { return writeJson([&p](ParamVisitor& v) { p.visit(v); }); };
    const bool wakes = impl_->sleep && text(next) != text(old);
    if (next.probes != old.probes)
        if (Status s = impl_->prepareProbes(next); !s) return s;
    if (wakes) impl_->sleep->disturbAll(impl_->clock.time);
    impl_->params = std::move(next);
    return ok();
}

std::vector<Pose> FluidWorld::drawnPoses() const {
    const Impl& w = *impl_;
    std::vector<Pose> poses = w.solids.poses();
    if (w.params.fixedStep > 0 && w.posesBefore.size() == poses.size())
        for (size_t k = 0; k < poses.size(); ++k) poses[k] = between(w.posesBefore[k], poses[k], double{w.stepper.share()});
    return poses;
}

ParticleView FluidWorld::particles() const {
    const Impl& w = *impl_;
    // What fell asleep within the last fixed step is still drawn on its way.
    std::shared_ptr<const void> sleepers = w.sleep ? w.grid->sleepers() : nullptr;
    if (w.params.fixedStep > 0 && sleepers != w.sleepersBefore) sleepers = nullptr;
    if (sleepers && sleepers == w.painted.of) sleepers = w.painted.shown;
    std::array<const Buffer*, kMostAttributes> attributes{};
    for (size_t k = 0; k < w.particles.attributes.size(); ++k) attributes[k] = &w.particles.attributes[k];
    return {.position = &w.particles.positionNext,
            .velocity = &w.particles.velocityNext,
            .id = &w.particles.id,
            .normal = w.particles.hasNormals ? &w.particles.normal : nullptr,
            .count = w.slots,
            .slots = w.particles.count,
            .absorption = w.coloured ? &w.particles.absorption : nullptr,
            .matterOf = w.traits.matter ? &w.particles.matterOf : nullptr,
            .attributes = attributes,
            .spacing = w.params.spacing,
            .mass = w.params.restDensity * w.params.spacing * w.params.spacing * w.params.spacing,
            .viscosity = w.traits.matter ? std::max(w.params.viscosity, w.mostViscous) : w.params.viscosity,
            .drawn = &w.drawn.positions(w.particles),
            .ellipsoids = w.params.ellipsoids ? w.ellipsoids.buffers() : std::array<const Buffer*, 3>{},
            .asleep = sleepers ? w.particles.count - w.grid->awakeSlots() : 0,
            .sleepers = sleepers,
            .foam = w.foam ? &w.foam->foam() : nullptr,
            .foamDrawn = w.foam ? &w.foam->drawn() : nullptr,
            .foamVelocity = w.foam ? &w.foam->velocity() : nullptr,
            .foamSlots = w.foam ? w.foam->slots() : 0,
            .revision = w.revision};
}

WetnessView FluidWorld::wetness() const {
    if (!impl_->wet) return {};
    return {impl_->wet->surface(), &impl_->wet->values(), &impl_->wet->cells()};
}

Result<std::unique_ptr<FluidWorld>> FluidWorld::create(Device& device, const FluidParams& params, const Solids& solids, Log log,
                                                       Sources sources, std::span<const HostForce> forces, const StartProgress& progress) {
    try {
        if (Status s = checkParams("fluid", params); !s) return s.error();
        device.goOn();
        const BoxParams& box = params.box;
        if (!glm::all(glm::lessThan(box.min, box.max)))
            return badInput(fmt::format("fluid.box.min [{}, {}, {}] m must lie below fluid.box.max [{}, {}, {}] m on every axis", box.min.x,
                                        box.min.y, box.min.z, box.max.x, box.max.y, box.max.z));
        std::unique_ptr<FluidWorld> world(new FluidWorld());
        Impl& w = *world->impl_;
        if (Status s = checkAttributes(params); !s) return s.error();
        w.device = &device;
        w.params = params;
        w.sourceSetup = std::move(sources);
        Result<WorldForces> worldForces = WorldForces::create(forces);
        if (!worldForces) return worldForces.error();
        w.forces = std::move(*worldForces);
        if (Status s = takeLiquid(w.params); !s) return s.error();
        if (device.backend() != Backend::cpu && params.workGroup != FluidParams{}.workGroup)
            w.traits.workGroup = static_cast<uint32_t>(params.workGroup);
        w.traits.linked = params.grid == "linked_list";
        if (w.traits.linked)
            if (Status can = w.mayLink(); !can) return can.error();
        Result<SolidPasses> passes = SolidPasses::create(device, solids, w.params, w.traits.threadDefines());
        if (!passes) return passes.error();
        w.solids = std::move(*passes);
        Result<BodyPasses> bodies =
            BodyPasses::create(device, solids.bodies, solids.bodyHost, w.params,
                               {.periodic = params.box.periodic(), .asleepRows = params.sleep.on && device.backend() != Backend::cpu});
        if (!bodies) return bodies.error();
        w.bodies = std::move(*bodies);
        w.log = std::move(log);
        w.gravity = params.gravity;
        w.progress = progress;
        if (Status s = w.prepare(solids); !s) return s.error();
        w.probeTargets = ProbeTargets::of(solids);
        if (Status s = w.prepareProbes(w.params); !s) return s.error();
        w.progress = {};
        if (w.cancelled) return failed("the creation of the water was cancelled");
        if (w.startInterrupted || device.interrupted() || device.stopAsked()) return failed("the creation of the water was interrupted");
        return world;
    } catch (const std::bad_alloc&) {
        return noMemory(
            "there is not enough memory for the water: use fewer particles, or lower fluid.maxParticles or fluid.bodies.maxSamples");
    }
}

}  // namespace rivulet
