// The steps of a world: how a frame becomes substeps, and the passes of one.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <new>

#include "fluid/sim/world/contradictions.h"
#include "fluid/sim/world/fluid_world_impl.h"

namespace rivulet {

namespace {

// m/s, where speeds have no limit: its square is still a float.
constexpr float kAnySpeed = 1.0e18F;

std::string refusedGravity(const vec3& g) {
    return fmt::format("the gravity ({}, {}, {}) m/s^2 given to a step is not finite, or beyond {} along an axis", g.x, g.y, g.z,
                       kMostGravity);
}

}  // namespace

bool FluidWorld::Impl::build(bool fromPositions, double from, double to) {
    if (glm::any(traits.periodic) && fromPositions)
        device->run(wrapFromPositions, step, {&corner, &particles.positionNext, &particles.velocityNext}, step.awakeSlots);
    bodies.place(step, particles);
    const bool asleepToo = grid->sortsAsleep();
    if (Status built = grid->build(step, particles); !built) {
        if (!device->interrupted()) shortage = built.error();
        return false;
    }
    if (Status moved = solids.advance(params, step, glm::length(gravity), from, to); !moved) {
        if (moved.error().memory) {
            grid->undo(particles);
            shortage = moved.error();
            return false;
        }
        report(moved.error().message);
    }
    particles.hasNormals = false;
    if (!asleepToo) step.awakeSlots = grid->awakeSlots();
    if (traits.matter)
        device->run(gatherMatter, step, {&grid->cellStart(), &particles.id, &particles.matterOf, &particles.matter, &particles.pressure},
                    step.awakeSlots);
    if (sleep && asleepToo) sleep->recall(step, *grid, particles, method->asleepValues(particles, step).pressure);
    bodies.index(step, *grid, particles);
    return true;
}

// `from`, `to`: the shares of the frame's time at which it begins and ends.
bool FluidWorld::Impl::substep(double dt, double from, double to, bool last) {
    step.dt = static_cast<float>(dt);
    step.maxSpeed = params.limits ? std::min(static_cast<float>(params.spacing / dt), limits.fastestEver) : kAnySpeed;
    if (sleep) step.awakeSlots = grid->sortsAsleep() ? particles.count : grid->awakeSlots();
    bool built = false;
    if (around)
        if (Status there = follow(step); !there) {
            shortage = there.error();
            return false;
        }
    StepContext context{
        .device = *device,
        .fluid = params,
        .params = step,
        .grid = *grid,
        .particles = particles,
        .solve = solve,
        .fastest = figures->maxSpeed,
        .stats = statsRows,
        .build = [&](bool fromPositions) { return built = build(fromPositions, from, to); },
        .pushSamples = [&](const Buffer& position, const Buffer& pressures, float scale,
                           const vec3& weight) { bodies.push(step, *grid, particles, position, pressures, scale, weight); },
        .planes = solids.planes(),
        .nearWalls = [&](const Buffer& position) { solids.nearWalls(step, *grid, position, particles.nearWalls); },
        .followWalls = [&](const Buffer& a, const Buffer& b) { solids.followWalls(step, *grid, a, b, particles.nearWalls); },
        .forces = {},
        .wallFriction = [&](const Buffer& position, Buffer& into) { solids.friction(step, *grid, position, into); },
        .wallAdhesion =
            [&](const StepParams& s) {
                solids.adhesion(s, *grid, particles);
                if (probes) probes->adhesion(s);
            },
        .probes = probes ? &*probes : nullptr};
    context.hasForces = forces.anyOn();
    context.forces = [&] { forces.run(context); };
    method->step(context);
    sorted = built;
    if (!built || device->interrupted()) return false;
    iterations += solve.iterations;
    if (around) around->moved();
    stepped += figures->particles - figures->asleep;
    solids.collide(step, *grid, particles, probes ? &*probes : nullptr);
    if (glm::any(traits.periodic)) device->run(wrap, step, {&corner, &particles.positionNext}, step.awakeSlots);
    if (last) method->measure(context);
    if (probes) probes->bodies(step);
    bodies.advance(step, particles, dt);
    if (const std::optional<size_t> body = bodies.misled())
        report(fmt::format("the host's solver gave body {} a state that is not finite: the body keeps its last state", *body));
    const std::vector<NamedBuffer> remembered = method->remembered();
    dry.run(step, grid->cellStart(), particles, bodies.states(), bodies.rows(), remembered);
    sources.run({step, params, *grid, particles, solids, bodies, dry.volumes(), remembered}, clock.time + to * clock.frameLength, dt, last);
    if (device->interrupted()) return false;
    if (sleep)
        sleep->run(params, step, glm::length(gravity), *grid, particles, clock.time + to * clock.frameLength,
                   method->asleepValues(particles, step).pressure);
    return !device->interrupted();
}

double FluidWorld::acceptedSeconds(double seconds) { return impl_->accepted(seconds); }

double FluidWorld::Impl::accepted(double seconds) {
    if (!(seconds > 0)) return 0;
    const double most = params.longestFrame;
    if (seconds <= most || !params.limits) return seconds;
    clock.dropped += seconds - most;
    report(fmt::format("a frame was longer than fluid.longestFrame = {} s: the rest of it was dropped", params.longestFrame));
    return most;
}

Status FluidWorld::checkInputs(const FluidInputs& inputs, double seconds) const {
    if (!(seconds <= kLongestFrame))
        return badInput(fmt::format("a step of {} s is not finite, or longer than {} s: step in frames of a fraction of a second", seconds,
                                    kLongestFrame));
    if (inputs.gravity && !isWithin(*inputs.gravity, kMostGravity)) return badInput(refusedGravity(*inputs.gravity));
    return impl_->solids.checkFrame(inputs.poses, inputs.shapes, impl_->stepper.pending() + seconds);
}

Status FluidWorld::lastStep() const {
    if (Status whole = impl_->whole(); !whole) return whole;
    return impl_->last;
}

void FluidWorld::step(const FluidInputs& inputs, double seconds) {
    Impl& w = *impl_;
    w.last = ok();
    w.device->poll();
    if (!(seconds > 0) || w.device->stopAsked()) return;
    w.change();
    if (!(seconds <= kLongestFrame)) return w.report(checkInputs({}, seconds).error().message);
    if (w.last = w.whole(); !w.last) return w.report(w.last.error().message);
    w.device->goOn();  // another owner of buffers may have been interrupted
    const WorldClock clock = w.clock;
    const StepLimits limits = w.limits;
    const bool lacked = w.shortage.has_value();
    w.shortage.reset();
    int substeps = 0;
    struct Stepping {  // ends when a function of the host throws, too
        bool& on;
        explicit Stepping(bool& flag) : on(flag) { on = true; }
        ~Stepping() { on = false; }
        Stepping(const Stepping&) = delete;
        Stepping& operator=(const Stepping&) = delete;
    };
    std::optional<Stepping> stepping(w.stepping);
    try {
        if (Status room = w.prepareFrame(); room)
            substeps = w.stepFrame(inputs, seconds);
        else
            w.shortage = room.error();
    } catch (const std::bad_alloc&) {
        w.shortage = w.changing ? w.whole().error() : noMemory("there is not enough memory for a step: use fewer particles");
    }
    stepping.reset();
    if (!w.shortage) return;
    w.last = *w.shortage;
    if (substeps == 0 && w.whole()) {  // as it was before
        w.clock = clock;
        w.limits = limits;
    }
    if (!w.interrupted && !lacked) w.report(w.shortage->message);  // once, although its figures may differ
}

// All memory that a frame needs, but for neighbour lists, before anything moves. What is not possible for another reason is reported and
// left out.
Status FluidWorld::Impl::prepareFrame() {
    const FluidParams& p = params;
    if (particles.count == 0) return ok();
    const auto prepare = [this](const Status& done) {
        if (done || done.error().memory) return done;
        report(done.error().message);
        return ok();
    };
    if (p.fixedStep > 0) {
        if (Status room = prepare(drawn.prepare(*device, particles.count)); !room) return room;
        if (foam)
            if (Status room = prepare(foam->prepareDrawn()); !room) return room;
    }
    if (p.ellipsoids) {
        if (Status room = prepare(ellipsoids.prepare(*device, traits, particles.count)); !room) return room;
        if (sleep)
            if (Status room = prepare(sleep->prepareEllipsoids()); !room) return room;
    }
    Result<std::vector<std::string>> off = forces.update(*device, {p, particles.count, traits, methodOf(p).doesViscosity});
    if (!off) return off.error();
    for (const std::string& sentence : *off) report(sentence);
    return ok();
}

// The number of substeps. Those that were whole are kept if a lack of memory ends the frame (`shortage`); none: nothing has moved.
int FluidWorld::Impl::stepFrame(const FluidInputs& inputs, double seconds) {
    const double now = accepted(seconds);
    const FluidParams& p = params;
    const bool cpu = device->backend() == Backend::cpu;
    ++clock.frame;
    sortedForQuery = false;
    if (particles.count == 0) {
        clock.time += now;
        return 0;
    }
    if (!cpu) stepper.recordTime(inputs.deviceMs, clock.lastSubsteps);
    clock.mostMs = inputs.mostMs;
    clock.budget = inputs.mostMs > 0 && (p.frameBudget <= 0 || inputs.mostMs < p.frameBudget) ? inputs.mostMs : double{p.frameBudget};
    const FrameStepper::Frame frame = stepper.begin(now, double{p.fixedStep}, clock.budget, !p.limits);
    warn();
    const double span = frame.before + seconds;  // until the solids reach their target poses
    clock.frameLength = span;
    const vec3 wanted = inputs.gravity.value_or(p.gravity);
    if (isWithin(wanted, kMostGravity))
        gravity = wanted;
    else
        report(refusedGravity(wanted) + ": the last gravity is kept");
    if (Status asked = solids.beginFrame(inputs.poses, inputs.shapes, span); !asked) report(asked.error().message);
    // It decays slowly: the speed of sound should not jump from frame to frame, nor keep a jump of a slider for ever.
    constexpr double kForget = 0.5;  // s
    limits.fastestWall = std::max(limits.fastestWall * static_cast<float>(std::exp(-now / kForget)), solids.fastestWall());
    if (sleep) disturbSleep();
    iterations = 0;
    if (probes) probes->begin();
    bodies.beginFrame(gravity, frame.pieces * frame.length);
    double simulated = 0;
    int substeps = 0, done = 0;
    bool stop = false;
    changing = true;
    while (done < frame.pieces && !stop) {
        if (p.fixedStep > 0) {
            drawn.remember(*device, particles);
            posesBefore = solids.poses();
            sleepersBefore = grid->sleepers();
        }
        simulated += stepPiece(frame.length, simulated, span, substeps, stop);
        ++done;
        if (done == frame.pieces || stop) break;
        if (p.fixedStep > 0)
            stop = !(cpu ? stepper.fitsMeasured(done) : stepper.fitsPredicted(substeps + clock.lastPiece - 1));
        else
            stop = !(cpu ? stepper.fitsMeasured(substeps) : stepper.fitsPredicted(substeps));
    }
    if ((interrupted = device->interrupted())) {
        changing = false;
        shortage = whole().error();
        return substeps;
    }
    if (!shortage || substeps > 0) endFrame(frame, seconds, simulated, substeps);
    changing = false;
    if ((interrupted = device->interrupted())) shortage = whole().error();
    return substeps;
}

// Ends a frame: prepares what is drawn of it and advances the time. If memory ran out during the frame, the time that was not stepped is
// dropped, and the neighbour lists are invalid.
void FluidWorld::Impl::endFrame(const FrameStepper::Frame& frame, double seconds, double simulated, int substeps) {
    const FluidParams& p = params;
    clock.lastSubsteps = substeps;
    clock.time += simulated;
    bodies.endFrame(clock.time);
    if (probes) probes->end(std::shared_ptr<ProbeFrame>(figures, &figures->loads), clock.time, simulated);
    gatherForDrawing();
    if (simulated > 0) volumes.count(step, particles, clock.time);
    if (shortage) {
        (void)stepper.end(simulated);
        ellipsoids.forget();
        drawn.forget();
        if (foam) foam->drawNewest();
        return;
    }
    if (p.ellipsoids && substeps > 0) {
        ellipsoids.find(*device, step, *grid, particles);
        if (hasFree && !traits.linked) ellipsoids.clearFree(*device, step, *grid, particles.count);
        if (sleep) sleep->keepEllipsoids(step, *grid, particles, ellipsoids.buffers(), clock.time);
    }
    if (!p.ellipsoids) ellipsoids.forget();
    if (foam && simulated > 0) foam->run(p, step, *grid, particles, solids, simulated);
    if (wet && simulated > 0) wet->run(p.wetness, step, *grid, particles, solids.poses(), bodies.states(), bodies.rows(), simulated);
    const double lost = stepper.end(simulated);
    // The rounding of a whole frame is no loss.
    if (lost > 1.0e-9 * seconds) {
        clock.dropped += lost;
        if (substeps < p.maxSubsteps && clock.budget > 0 && !clock.budgetReported) {
            clock.budgetReported = true;
            const StepLimit limit = stepLimit(clock.time, frame.length);
            report(
                fmt::format("a frame needs about {:.0f} steps, their length limited by {}, which take longer than {}: simulated time runs "
                            "slower than requested",
                            std::ceil(seconds / limit.dt), limit.why,
                            clock.budget == double{p.frameBudget} ? fmt::format("fluid.frameBudget = {} ms", p.frameBudget)
                                                                  : fmt::format("{:.0f} ms", clock.budget)));
        }
    }
    if (p.fixedStep > 0) {
        drawn.draw(*device, particles, stepper.share(), static_cast<float>(std::max(clock.lastPiece, 1) + 1) * p.spacing);
        if (foam) foam->drawEarlier((1.0 - double{stepper.share()}) * double{p.fixedStep});
    } else {
        drawn.forget();
        if (foam) foam->drawNewest();
    }
}

bool FluidWorld::interrupted() const { return impl_->interrupted; }

Status FluidWorld::Impl::whole() const {
    if (interrupted) return failed("the last step was interrupted, so that the state of the water is incomplete: reset or restore it");
    if (changing)
        return failed(
            "the last step, reset or restore did not end, because memory ran out or a function of the host did not return, so that the "
            "state of the water is incomplete: reset or restore it");
    if (const DeviceHealth health = device->health(); health.state == DeviceHealth::lost)
        return failed(
            fmt::format("{} {}: its results are invalid; use another backend, or fewer particles", device->info().name, health.why));
    return ok();
}

// StepParams without the step's length.
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
    // Water keeps for a while the speed that it had under other params, and that is no fault.
    limits.fastestEver = std::max(limits.fastestEver, limits.fastestPossible(limitInputs()));
}

// Steps a part of a frame: `length` s, beginning `begin` s after the frame's start. Solids move during the first `span` s of the frame.
// Returns the time stepped: less than `length` if maxSubsteps, the budget or a lack of memory ends the frame; `stop` is then set.
double FluidWorld::Impl::stepPiece(double length, double begin, double span, int& substeps, bool& stop) {
    fillStep();
    const StepLimit limit = stepLimit(clock.time + begin, length);
    int count = static_cast<int>(std::min(std::ceil(length / limit.dt - 1e-6), 1.0e9));
    count = std::max(count, 1);
    double dt = length / count;
    if (substeps + count > params.maxSubsteps) {
        count = params.maxSubsteps - substeps;
        dt = limit.dt;
        stop = true;
        report(fmt::format(
            "a frame needed more than fluid.maxSubsteps = {} steps, their length limited by {}: simulated time runs slower than requested",
            params.maxSubsteps, limit.why));
    }
    constexpr int kMany = 300;  // a frame of water needs 4 to 40
    if (count > kMany && params.limits && !clock.costReported) {
        clock.costReported = true;
        report(fmt::format("{:.3g} s need {} steps, their length limited by {}: the computation takes long", length, count, limit.why));
    }
    if (params.fixedStep > 0 && count > 1)
        report(fmt::format("fluid.fixedStep = {} s is cut into shorter steps, their length limited by {}", params.fixedStep, limit.why));
    const bool cpu = device->backend() == Backend::cpu;
    int done = 0;
    while (done < count) {
        if (!substep(dt, (begin + done * dt) / span, (begin + (done + 1) * dt) / span, done + 1 == count)) {
            stop = true;
            break;
        }
        ++done;
        ++substeps;
        // A fixed step is completed, unless the frame takes longer than FluidInputs::mostMs.
        const bool partial = !(params.fixedStep > 0) || (clock.mostMs > 0 && stepper.elapsedMs() > clock.mostMs);
        if (partial && done < count && !(cpu ? stepper.fitsMeasured(substeps) : stepper.fitsPredicted(substeps))) {
            stop = true;
            break;
        }
    }
    if (done == 0 || device->interrupted()) return 0;
    clock.lastPiece = done;
    clock.dtMin = clock.dtMin == 0 ? dt : std::min(clock.dtMin, dt);
    clock.dtMax = std::max(clock.dtMax, dt);
    sources.report();
    dry.report();
    if (!shortage) gatherStats(substeps, clock.time + begin + dt * done);
    return dt * done;
}

}  // namespace rivulet
