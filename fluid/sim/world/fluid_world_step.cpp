// The steps of a world: how a frame becomes substeps, and the passes of one.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "fluid/sim/world/fluid_world_impl.h"

namespace rivulet {

namespace {

// m/s, where speeds have no limit: its square is still a float.
constexpr float kAnySpeed = 1.0e18F;

}  // namespace

bool FluidWorld::Impl::build(bool fromPositions, double from, double to) {
    if (glm::any(traits.periodic) && fromPositions)
        device->run(wrapFromPositions, step, {&corner, &particles.positionNext, &particles.velocityNext}, step.awakeSlots);
    bodies.place(step, particles);
    const bool asleepToo = grid->sortsAsleep();
    if (Status built = grid->build(step, particles); !built) {
        if (!device->interrupted()) report(built.error().message);
        return false;
    }
    if (!asleepToo) step.awakeSlots = grid->awakeSlots();
    if (traits.matter)
        device->run(gatherMatter, step, {&grid->cellStart(), &particles.id, &particles.matterOf, &particles.matter, &particles.pressure},
                    step.awakeSlots);
    if (sleep && asleepToo) sleep->recall(step, *grid, particles, method->asleepValues(particles, step).pressure);
    bodies.index(step, *grid, particles);
    if (Status moved = solids.advance(params, step, glm::length(gravity), from, to); !moved) report(moved.error().message);
    return true;
}

// `from`, `to`: the shares of the frame's time at which it begins and ends.
bool FluidWorld::Impl::substep(double dt, double from, double to, bool last) {
    step.dt = static_cast<float>(dt);
    step.maxSpeed = params.limits ? std::min(static_cast<float>(params.spacing / dt), limits.fastestEver) : kAnySpeed;
    if (sleep) step.awakeSlots = grid->sortsAsleep() ? particles.count : grid->awakeSlots();
    bool built = false;
    if (around) {
        follow(step);
        around->moved();
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
    particles.hasNormals = false;
    context.forces = [&] { forces.run(context); };
    method->step(context);
    iterations += solve.iterations;
    sorted = built;
    if (!built || device->interrupted()) return false;
    stepped += figures->particles - figures->asleep;
    solids.collide(step, *grid, particles, probes ? &*probes : nullptr);
    if (glm::any(traits.periodic)) device->run(wrap, step, {&corner, &particles.positionNext}, step.awakeSlots);
    if (last) method->measure(context);
    if (probes) probes->bodies(step);
    bodies.advance(step, particles, dt);
    if (const std::optional<size_t> body = bodies.misled())
        report(fmt::format("the host's solver gave body {} a state that is not finite: the body keeps its last state", *body));
    const std::vector<NamedBuffer> remembered = method->remembered();
    sources.run({step, params, *grid, particles, solids, bodies, remembered}, clock.time + to * clock.frameLength, dt, last);
    if (device->interrupted()) return false;
    if (sleep)
        sleep->run(params, step, glm::length(gravity), *grid, particles, clock.time + to * clock.frameLength,
                   method->asleepValues(particles, step).pressure);
    return !device->interrupted();
}

double FluidWorld::acceptedSeconds(double seconds) {
    Impl& w = *impl_;
    if (!(seconds > 0)) return 0;
    const double most = w.params.longestFrame;
    if (seconds <= most || !w.params.limits) return seconds;
    w.clock.dropped += seconds - most;
    w.report(fmt::format("a frame was longer than fluid.longestFrame = {} s: the rest of it was dropped", w.params.longestFrame));
    return most;
}

void FluidWorld::step(const FluidInputs& inputs, double seconds) {
    Impl& w = *impl_;
    w.device->poll();
    if (!(seconds > 0) || w.refusesStep()) return;
    const double now = acceptedSeconds(seconds);
    ++w.clock.frame;
    w.sortedForQuery = false;
    if (w.particles.count == 0) {
        w.clock.time += now;
        return;
    }
    const FluidParams& p = w.params;
    const bool cpu = w.device->backend() == Backend::cpu;
    if (!cpu) w.stepper.recordTime(inputs.deviceMs, w.clock.lastSubsteps);
    const FrameStepper::Frame frame = w.stepper.begin(now, double{p.fixedStep}, double{p.frameBudget}, !p.limits);
    w.warn();
    const double span = frame.before + seconds;  // until the solids reach their target poses
    w.clock.frameLength = span;
    const vec3 gravity = inputs.gravity.value_or(p.gravity);
    if (isFinite(gravity))
        w.gravity = gravity;
    else
        w.report("the gravity given to a step is not finite: the last gravity is kept");
    if (Status asked = w.solids.beginFrame(inputs.poses, inputs.shapes, span); !asked) w.report(asked.error().message);
    // It decays slowly: the speed of sound should not jump from frame to frame, nor keep a jump of a slider for ever.
    constexpr double kForget = 0.5;  // s
    w.limits.fastestWall = std::max(w.limits.fastestWall * static_cast<float>(std::exp(-now / kForget)), w.solids.fastestWall());
    for (const std::string& off : w.forces.update(*w.device, {p, w.particles.count, w.traits, methodOf(p).doesViscosity})) w.report(off);
    if (w.sleep) w.disturbSleep();
    w.iterations = 0;
    if (w.probes) w.probes->begin();
    double stepped = 0;
    int substeps = 0, done = 0;
    bool stop = false;
    while (done < frame.pieces && !stop) {
        if (p.fixedStep > 0) {
            if (Status ready = w.drawn.prepare(*w.device, w.particles.count); !ready) w.report(ready.error().message);
            w.drawn.remember(*w.device, w.particles);
            w.posesBefore = w.solids.poses();
            w.sleepersBefore = w.grid->sleepers();
        }
        stepped += w.stepPiece(frame.length, stepped, span, substeps, stop);
        ++done;
        if (done == frame.pieces || stop) break;
        if (p.fixedStep > 0)
            stop = !(cpu ? w.stepper.fitsMeasured(done) : w.stepper.fitsPredicted(substeps + w.clock.lastPiece - 1));
        else
            stop = !(cpu ? w.stepper.fitsMeasured(substeps) : w.stepper.fitsPredicted(substeps));
    }
    if ((w.interrupted = w.device->interrupted())) return;
    w.clock.lastSubsteps = substeps;
    w.clock.time += stepped;
    if (w.probes) w.probes->end(std::shared_ptr<ProbeFrame>(w.figures, &w.figures->loads), w.clock.time, stepped);
    w.gatherColours();
    if (stepped > 0) w.volumes.count(w.step, w.particles, w.clock.time);
    if (p.ellipsoids && substeps > 0) {
        if (Status ready = w.ellipsoids.prepare(*w.device, w.traits, w.particles.count); !ready) w.report(ready.error().message);
        w.ellipsoids.find(*w.device, w.step, *w.grid, w.particles);
        if (w.sources.any() && !w.traits.linked) w.ellipsoids.clearFree(*w.device, w.step, *w.grid, w.particles.count);
        if (w.sleep)
            if (Status kept = w.sleep->keepEllipsoids(w.step, *w.grid, w.particles, w.ellipsoids.buffers(), w.clock.time); !kept)
                w.report(kept.error().message);
    }
    if (!p.ellipsoids) w.ellipsoids.forget();
    if (w.foam && stepped > 0) w.foam->run(p, w.step, *w.grid, w.particles, w.solids, stepped);
    const double lost = w.stepper.end(stepped);
    // The rounding of a whole frame is no loss.
    if (lost > 1.0e-9 * seconds) {
        w.clock.dropped += lost;
        if (substeps < p.maxSubsteps && p.frameBudget > 0 && !w.clock.budgetReported) {
            w.clock.budgetReported = true;
            w.report(
                fmt::format("a frame's steps take longer than fluid.frameBudget = {} ms, their length limited by {}: simulated time runs "
                            "slower than requested",
                            p.frameBudget, w.stepLimit(w.clock.time, frame.length).why));
        }
    }
    if (p.fixedStep > 0) {
        w.drawn.draw(*w.device, w.particles, w.stepper.share(), static_cast<float>(std::max(w.clock.lastPiece, 1) + 1) * p.spacing);
        if (w.foam)
            if (Status back = w.foam->drawEarlier((1.0 - double{w.stepper.share()}) * double{p.fixedStep}); !back)
                w.report(back.error().message);
    } else {
        w.drawn.forget();
        if (w.foam) w.foam->drawNewest();
    }
    w.interrupted = w.device->interrupted();
}

bool FluidWorld::interrupted() const { return impl_->interrupted; }

bool FluidWorld::Impl::refusesStep() {
    if (device->stopAsked()) return true;
    if (interrupted) {
        report(whole().error().message);
        return true;
    }
    device->goOn();  // another owner of buffers may have been interrupted
    return false;
}

Status FluidWorld::Impl::whole() const {
    if (!interrupted) return ok();
    return failed("the last step was interrupted, so that the state of the water is incomplete: reset or restore it");
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

// Steps `length` s, from `begin` s after the start of a frame whose solids move for `span` s. Returns the time that it stepped:
// less if maxSubsteps, the budget or a lack of memory end it; the rest of the frame is then not stepped.
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
        // A fixed step is always completed.
        if (!(params.fixedStep > 0) && done < count && !(cpu ? stepper.fitsMeasured(substeps) : stepper.fitsPredicted(substeps))) {
            stop = true;
            break;
        }
    }
    if (done == 0 || device->interrupted()) return 0;
    clock.lastPiece = done;
    clock.dtMin = clock.dtMin == 0 ? dt : std::min(clock.dtMin, dt);
    clock.dtMax = std::max(clock.dtMax, dt);
    sources.report();
    gatherStats(substeps, clock.time + begin + dt * done);
    return dt * done;
}

}  // namespace rivulet
