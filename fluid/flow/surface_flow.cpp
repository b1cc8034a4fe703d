#include "engine/core/assert.h"
#include "fluid/flow/surface_flow_impl.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "engine/core/param_check.h"
#include "engine/core/param_fixed.h"
#include "fluid/sim/world/fluid_params.h"
#include "fluid/sim/world/pose.h"
#include "shaders/flow/facing.h"

namespace rivulet {

namespace {

constexpr float kFarthest = 1.0e5F;  // m

bool isFinite(const dmat4& m) {
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row)
            if (!std::isfinite(m[column][row])) return false;
    return true;
}

}  // namespace

Status SurfaceFlow::Impl::checkPlace(uint32_t k, const vec3& position) {
    if (!isFinite(position)) return badInput(fmt::format("position {} of a skin is not a finite number", k));
    if (glm::any(glm::greaterThan(glm::abs(position), vec3(kFarthest))))
        return badInput(
            fmt::format("position {} of a skin is more than {:.0e} m from zero, where floats are too coarse for drops", k, kFarthest));
    return ok();
}

Status SurfaceFlow::Impl::checkPositions(std::span<const vec3> positions) const {
    if (positions.empty()) return ok();
    for (const uint32_t k : mesh.given) {
        if (k >= positions.size())
            return badInput(fmt::format("a skin has {} positions, too few: its triangles use number {}", positions.size(), k));
        const vec3 x = glm::abs(positions[k]);
        if (x.x <= kFarthest && x.y <= kFarthest && x.z <= kFarthest) continue;  // most: a Status for each takes longer than the test
        if (Status sound = checkPlace(k, positions[k]); !sound) return sound;
    }
    return ok();
}

double dragOf(const SurfaceFlowParams& p) {
    constexpr double kOuter = 1.0e-3;  // m, about a drop's height
    if (!(p.wallFriction > 0)) return double{p.drag};
    const double advancing = double{p.advancing} * kRadian, receding = double{std::min(p.receding, p.advancing)} * kRadian;
    const double slip = double{p.viscosity} / double{p.wallFriction};
    const double wedges = std::sin(receding) / (receding * receding) + std::sin(advancing) / (advancing * advancing);
    return 3 * double{p.hold} * wedges * std::log(std::max(kOuter / slip, 2.0));
}

double cornerSpeed(const SurfaceFlowParams& p) {
    constexpr double kLog = 8.4;
    const double receding = std::max(double{std::min(p.receding, p.advancing)}, 10.0) * kRadian;
    return (1 - double{CORNER_LEAVES}) * receding * receding * receding / (9 * kLog) * double{p.surfaceTension} / double{p.viscosity};
}

// Of the corner's speed: cusps begin at the root of 2, where the corner's half angle is 45 degrees, and shed drops soon after.
constexpr double kPearling = 1.49;

FlowStep SurfaceFlow::Impl::stepOf(const SurfaceFlowInputs& inputs, const StepParams& s, double seconds) const {
    constexpr double kAirDensity = 1.2;  // kg/m^3
    const SurfaceFlowParams& p = params;
    const double advancing = double{p.advancing} * kRadian, receding = double{std::min(p.receding, p.advancing)} * kRadian;
    FlowStep f{};
    const dmat3 fromWorld = glm::transpose(dmat3(inputs.toWorld));
    f.pull = vec4(vec3(fromWorld * dvec3(inputs.gravity)), 0.0F);
    f.wind = vec4(vec3(fromWorld * dvec3(inputs.wind)), 0.0F);
    f.count = count();
    f.triangles = static_cast<uint32_t>(mesh.triangleCount());
    f.places = static_cast<uint32_t>(mesh.rest.size());
    f.births = static_cast<uint32_t>(births.size());
    f.insideAt = s.cellCount;
    f.freeAt = s.totalCells + 2;
    f.dt = static_cast<float>(seconds);
    f.density = p.density;
    f.contactRadius = static_cast<float>(contactRadius(meanAngle(p)));
    f.hold = static_cast<float>(double{p.hold * p.surfaceTension} * (std::cos(receding) - std::cos(advancing)));
    f.drag = static_cast<float>(dragOf(p) * double{p.viscosity});
    if (pendant) {
        const dvec3 hangs = pendant->inverse() / std::max(double{p.adhesion}, 1.0e-6);
        f.hangs0 = static_cast<float>(hangs.x);
        f.hangs1 = static_cast<float>(hangs.y);
        f.hangs2 = static_cast<float>(hangs.z);
        f.falls0 = static_cast<float>(pendant->falling().x);
        f.falls1 = static_cast<float>(pendant->falling().y);
    }
    f.airDrag = static_cast<float>(0.5 * kAirDensity * double{p.airDrag} * 0.4);  // a cap's height is about 0.4 of its width
    f.trail = p.trail;
    f.trailWidth = p.trailWidth;
    f.slip = p.slip;
    f.steer = p.steer;
    f.cell = p.filmCell;
    const double reach = p.filmReach;
    f.viscosity = p.viscosity;
    f.filmReach = p.filmReach;
    f.filmSelf = static_cast<float>(7 / (kPiD * reach * reach));
    f.filmRadius = static_cast<float>(kFilmRadius * reach);
    f.jump = kJump;
    f.inverseDt = static_cast<float>(1 / seconds);
    f.tension = p.surfaceTension;
    f.brimAt = static_cast<uint32_t>(p.capacity);
    f.brims = brims;
    f.brimMost = brimPlaces == 0 ? 1.0F : p.brimHolds * 1.0e6F * static_cast<float>(brims) / static_cast<float>(brimPlaces);
    f.brimRadius = p.brimWidth;
    f.tear = p.tear * 1.0e6F;
    f.pearlPace = static_cast<float>(kPearling * cornerSpeed(p));
    f.settle = static_cast<float>(1 - std::exp(-seconds / kSettling));
    return f;
}

Status SurfaceFlow::setThesis(const ThesisParams& params) {
    ASSERT(impl_->thesis, "only a flow of createThesis() has these");
    if (Status s = checkParams("thesis", params); !s) return s;
    impl_->thesis->setParams(params);
    return ok();
}

Status SurfaceFlow::setParams(const SurfaceFlowParams& params) {
    if (Status s = checkParams("liquid", params); !s) return s;
    SurfaceFlowParams next = params;
    keepFixed(next, impl_->params);
    impl_->params = next;
    return ok();
}

void SurfaceFlow::Impl::spawn(const FlowBirth& one) {
    if (one.volume == 0) return;
    added += one.volume;
    if (births.size() >= count()) {
        reports->refused += one.volume;
        return;
    }
    largestBirth = std::max(largestBirth, one.volume);
    births.push_back(one);
}

void SurfaceFlow::add(const SkinPoint& at, uint32_t picolitres, const vec3& velocity, bool film) {
    ASSERT(at.triangle < impl_->mesh.triangleCount(), "a drop's triangle is one of mesh()'s");
    impl_->spawn({vec4(velocity, film ? 1.0F : 0.0F), at.triangle, at.b1, at.b2, picolitres});
}

void SurfaceFlow::addToBrim(uint32_t place, uint32_t picolitres) {
    ASSERT(place < impl_->brimPlaces, "a brim's place is one of those given to create()");
    impl_->spawn({vec4(0.0F), DROP_BRIM | place, 0.0F, 0.0F, picolitres});
}

void SurfaceFlow::setGrip(std::span<const float> grip) {
    Impl& w = *impl_;
    ASSERT(grip.size() == w.mesh.rest.size(), "one number a place of mesh()");
    std::vector<vec4> table = w.device->readAll<vec4>(w.driven, 2 * grip.size());
    for (size_t p = 0; p < grip.size(); ++p) table[2 * p].w = grip[p] * w.uneven[p];
    w.device->writeAll<vec4>(w.driven, table);
}

// How the motion of the skin's frame acts on drops: turn rotates velocities, drift x is the frame's own velocity at x.
void SurfaceFlow::Impl::turnFrame(const dmat4& toWorld, double seconds, FlowStep& f) {
    const dmat4 before = posed ? glm::inverse(toWorld) * pose : dmat4(1.0);  // coordinates of a fixed point before -> now
    pose = toWorld;
    posed = true;
    vec4* turn[] = {&f.turn0, &f.turn1, &f.turn2};
    vec4* drift[] = {&f.drift0, &f.drift1, &f.drift2};
    double fastest = 0;
    for (int row = 0; row < 3; ++row) {
        *turn[row] = vec4(before[0][row], before[1][row], before[2][row], 0.0F);
        *drift[row] = vec4(((row == 0 ? 1 : 0) - before[0][row]) / seconds, ((row == 1 ? 1 : 0) - before[1][row]) / seconds,
                           ((row == 2 ? 1 : 0) - before[2][row]) / seconds, -before[3][row] / seconds);
        for (const vec3& x : {corners.min, corners.max})
            fastest = std::max(fastest, std::abs(double{glm::dot(vec3(*drift[row]), x)} + double{drift[row]->w}));
    }
    if (fastest > kJump)  // moved by the user
        for (vec4* row : drift) *row = vec4(0.0F);
}

// The mesh's positions, from host memory or from the device.
void SurfaceFlow::Impl::moveSkin(const SurfaceFlowInputs& inputs, const FlowStep& f) {
    const Buffer* from = inputs.moved;
    if (from == nullptr && !inputs.positions.empty()) {
        // In parts: a copy of all of them would be allocated in each step.
        std::array<vec4, 4096> part;
        const size_t used = hostMoved.bytes() / sizeof(vec4);
        for (size_t first = 0; first < used; first += part.size()) {
            const size_t n = std::min(part.size(), used - first);
            for (size_t k = 0; k < n; ++k) part[k] = vec4(inputs.positions[first + k], 0.0F);
            device->write(hostMoved, std::as_bytes(std::span(part).first(n)), first * sizeof(vec4));
        }
        from = &hostMoved;
    }
    if (from != nullptr) {
        FlowStep t = f;
        if (steps == 1) t.inverseDt = 0;  // the first pose is where the skin is, not a motion
        device->run(take, t, {&given, from, &point, &driven}, f.places);
        moved = stirring = true;
    } else if (stirring) {
        device->run(rest, f, {&driven}, f.places);
        stirring = false;
    }
    if (thesis && !moved) thesis->makeField(forThesis(), f, false);
    if (!moved) return;
    device->run(basis, f, {&skin, &point, &frames}, f.triangles);
    if (thesis) {
        device->run(drive, f, {&begin, &footprint, &weight, &frames, &wanted, &driven, &point}, f.places);
        thesis->makeField(forThesis(), f, true);
    }
    moved = false;
    ++moves;
}

Status SurfaceFlow::step(const SurfaceFlowInputs& inputs, double seconds) {
    Impl& w = *impl_;
    w.device->poll();
    if (!(seconds > 0)) return ok();
    if (Status places = w.checkPositions(inputs.positions); !places) return places;
    if (!isFinite(inputs.toWorld) || !isWithin(inputs.gravity, kMostGravity) || !isWithin(inputs.wind, kMostGravity))
        return badInput(
            fmt::format("a skin's toWorld is not finite, or its gravity or wind is not finite or beyond {} m/s^2 or m/s", kMostGravity));
    StepParams s{};
    s.count = s.firstSample = w.count();
    w.grid->fill(s);
    s.h = 1 / s.gridScale.x;
    s.invH = s.gridScale.x;
    FlowStep f = w.stepOf(inputs, s, seconds);
    f.number = ++w.steps;
    f.everywhere = w.thesis ? 1 : 0;
    for (double& since : w.sinceTurn) since += seconds;
    w.phase = (w.phase + 1) % DRY_EVERY;
    f.dryPhase = w.phase;
    f.dries = static_cast<float>(double{w.params.evaporation} * w.sinceTurn[w.phase]);
    w.sinceTurn[w.phase] = 0;

    w.time += seconds;
    w.turnFrame(inputs.toWorld, seconds, f);
    w.moveSkin(inputs, f);
    w.takePlaces(inputs);
    w.device->fill(w.counter, 0);
    if (!w.thesis) w.device->fill(w.hangs, 0);
    // Of the steps before this one, those that are not reported yet.
    const size_t reported = w.bornSince.size() - std::min<size_t>(w.steps - 1 - w.reports->sortedIn, w.bornSince.size());
    w.bornSince.erase(w.bornSince.begin(), w.bornSince.begin() + static_cast<std::ptrdiff_t>(reported));
    w.bornSince.push_back(f.births);
    if (!w.births.empty()) {
        w.device->write(w.birth, std::as_bytes(std::span(w.births)));
        w.device->run(w.born, f, {&w.grid->cellStart(), &w.drops.id, &w.birth, &w.drop, &w.motion, &w.counter}, f.births);
        w.reports->film =
            w.reports->film || std::any_of(w.births.begin(), w.births.end(), [](const FlowBirth& b) { return b.velocity.w > 0; });
        w.births.clear();
    }
    if (f.brims > 0)
        w.device->run(w.brim, f, {&w.chain, &w.spill, &w.grid->cellStart(), &w.drops.id, &w.frames, &w.drop, &w.motion, &w.counter},
                      f.brims);
    if (w.params.pearls && !w.thesis && w.steps > 1)
        w.device->run(w.pearl, f, {&w.grid->cellStart(), &w.drops.id, &w.skin, &w.frames, &w.drop, &w.motion, &w.counter}, f.count);
    // The force that holds a film's edge is stiff; single drops have none.
    const int parts = w.thesis ? w.thesis->parts(seconds) : w.reports->film ? static_cast<int>(std::ceil(seconds / kFilmStep)) : 1;
    for (int k = 0; k < parts; ++k) {
        w.setStep(f, s, seconds / parts);
        f.reports = k + 1 == parts ? 1 : 0;
        if (Status moved = w.thesis ? w.moveThesis(f, s) : w.moveDrops(f, s); !moved) return moved;
        f.turn0 = vec4(1, 0, 0, 0);  // the frame has already turned
        f.turn1 = vec4(0, 1, 0, 0);
        f.turn2 = vec4(0, 0, 1, 0);
    }
    if (f.dries > 0)
        w.device->run(w.dry, f, {&w.skin, &w.frames, &w.painted, &w.film, &w.counter}, (f.triangles + DRY_EVERY - 1) / DRY_EVERY);
    w.takeCounters(f.freeAt);
    return ok();
}

// Sets the values that depend on the length of a step.
void SurfaceFlow::Impl::setStep(FlowStep& f, StepParams& s, double seconds) const {
    f.dt = s.dt = static_cast<float>(seconds);
    f.inverseDt = static_cast<float>(1 / seconds);
    s.force = vec4(params.touch, static_cast<float>(double{params.largestDrop} * kMicrolitre), 1 / params.filmReach, f.filmSelf);
    s.relaxation = static_cast<float>(1 - std::exp(-seconds / kCalming));
    const double reach = params.filmReach, gamma = double{params.surfaceTension} / double{params.density};
    s.gravity = vec4(vec3(f.pull), static_cast<float>(gamma * kPiD * kPiD / (reach * reach)));
    s.stiffness = static_cast<float>(gamma * (1 - std::cos(meanAngle(params) * kRadian)));
    s.spacing = static_cast<float>(reach * kThinnest);
    if (const double pull = double{glm::length(vec3(f.pull))}; pendant && pull > 0) {
        // A drop may exceed what hangs, as it lets go then.
        const double hangs = 1.5 * double{params.adhesion} * pendant->largest(0) * std::pow(gamma / pull, 1.5);
        s.boxMin = vec4(vec3(f.pull) * static_cast<float>(std::max(hangs - double{params.largestDrop} * kMicrolitre, 0.0) / pull), 0.0F);
    }
}

// Finds other skin that drops touch, within the height of the largest drop.
void SurfaceFlow::Impl::touchOthers(const FlowStep& f, const StepParams& s) {
    if (!params.contact || f.places > FACING_PLACES) return;
    StepParams c = s;
    const double volume = std::cbrt(double{params.largestDrop} * kMicrolitre);
    const auto widest = static_cast<float>(contactRadius(meanAngle(params)) * volume);
    c.force = vec4(widest, 1 / widest, 0.0F, 0.0F);
    c.iteration = f.places;
    const uint32_t finer = s.cellCount / static_cast<uint32_t>(s.cellsX * s.cellsY * s.cellsZ);
    c.correction = static_cast<float>(finer);
    device->fill(faces, UINT32_MAX);
    device->fill(reached, 0);
    device->run(mark, c, {&grid->cellStart(), &drops.position, &drops.velocity, &side, &reached}, f.count);
    device->run(facing, c, {&grid->cellStart(), &drops.position, &drops.velocity, &side, &point, &frames, &faces, &reached}, f.places);
    device->run(goOver, f, {&drops.id, &faces, &skin, &frames, &point, &side, &drop}, f.count);
}

Status SurfaceFlow::Impl::moveDrops(const FlowStep& f, const StepParams& s) {
    device->run(place, f, {&drops.id, &skin, &frames, &driven, &drop, &motion, &drops.positionNext, &drops.velocityNext}, f.count);
    if (Status sorted = grid->build(s, drops); !sorted) return sorted;
    device->run(name, f, {&drops.id, &drop, &frames, &names, &sortedOf, &side, &counter}, f.count);
    const uint32_t threads = grid->pairThreads();
    const Buffer& neighbors = grid->neighbors();
    const Buffer &x = drops.position, &v = drops.velocity;
    spread.run(*device, drops, s, {&neighbors, &x, &v, &side, &names, &merged}, threads);
    meet.run(*device, drops, s, {&neighbors, &x, &v, &side, &names, &into}, threads);
    gather.run(*device, drops, s, {&neighbors, &x, &v, &names, &into, &side, &merged, &shift}, threads);
    if (reports->film) press.run(*device, drops, s, {&neighbors, &x, &v, &side, &merged}, threads);
    device->run(merge, f, {&grid->cellStart(), &drops.id, &sortedOf, &into, &drop, &counter}, f.count);
    touchOthers(f, s);
    device->run(stand, f, {&drops.id, &drop, &skin, &wanted}, f.count);
    device->run(drive, f, {&begin, &footprint, &weight, &frames, &wanted, &driven, &point}, f.places);
    device->run(law, f, {&drops.id, &skin, &frames, &driven, &merged, &drop, &motion, &hangs}, f.count);
    device->run(steer, f, {&drops.id, &skin, &frames, &film, &merged, &drop, &driven, &motion}, f.count);
    device->run(walk, f, {&drops.id, &skin, &frames, &shift, &drop, &motion}, f.count);
    device->run(paint, f, {&drops.id, &skin, &frames, &motion, &film, &drop, &painted}, f.count);
    device->run(leave, f, {&drops.id, &frames, &motion, &drop, &counter, &left}, f.count);
    return ok();
}

// The same walk on other tables; drops leave from the skin in space.
Status SurfaceFlow::Impl::moveThesis(const FlowStep& step, const StepParams& s) {
    FlowStep f = step;
    f.trail = 0;
    const Buffer &layout = thesis->skin(), &flat = thesis->flat();
    if (Status pressed = thesis->press(forThesis(), f, s); !pressed) return pressed;
    device->run(steer, f, {&drops.id, &layout, &flat, &film, &merged, &drop, &driven, &motion}, f.count);
    device->run(walk, f, {&drops.id, &layout, &flat, &shift, &drop, &motion}, f.count);
    thesis->releaseDrops(forThesis(), f);
    device->run(leave, f, {&drops.id, &frames, &motion, &drop, &counter, &left}, f.count);
    return ok();
}

std::vector<SkinDrop> SurfaceFlow::drops() const {
    const Impl& w = *impl_;
    const auto state = w.device->readAll<uint32_t>(w.drop, size_t{w.count()} * DROP_UINTS);
    const auto motion = w.device->readAll<vec4>(w.motion, MOTION_VECS * size_t{w.count()});
    const auto frames = w.device->readAll<vec4>(w.frames, 5 * w.mesh.triangleCount());
    std::vector<vec4> flat;
    if (w.thesis) flat = w.device->readAll<vec4>(w.thesis->flat(), 5 * w.mesh.triangleCount());
    std::vector<SkinDrop> all;
    for (uint32_t k = 0; k < w.count(); ++k) {
        const uint32_t* d = &state[size_t{k} * DROP_UINTS];
        if (d[DROP_VOLUME] == 0) continue;
        const SkinPoint at{d[DROP_TRIANGLE] & DROP_NUMBER, std::bit_cast<float>(d[DROP_B1]), std::bit_cast<float>(d[DROP_B2])};
        const vec4* basis = &frames[5 * size_t{at.triangle}];
        vec3 velocity(motion[MOTION_VECS * size_t{k}]);
        if (w.thesis) {  // UV/s
            const vec4* uv = &flat[5 * size_t{at.triangle}];
            velocity = vec3(basis[1]) * glm::dot(vec3(uv[3]), velocity) + vec3(basis[2]) * glm::dot(vec3(uv[4]), velocity);
        }
        all.push_back({k, at, vec3(basis[0]) + at.b1 * vec3(basis[1]) + at.b2 * vec3(basis[2]), velocity, d[DROP_VOLUME] * 1.0e-15,
                       double{motion[MOTION_VECS * size_t{k}].w}, double{std::bit_cast<float>(d[DROP_SHARE])}});
    }
    return all;
}

const PendantDrop* SurfaceFlow::pendant() const { return impl_->pendant ? &*impl_->pendant : nullptr; }

FlowView SurfaceFlow::view() const {
    const Impl& w = *impl_;
    // Three drops may merge with a fourth at once: a quarter wider than the largest.
    const double largest = 2 * std::max(double{w.params.largestDrop} * kMicrolitre, w.largestBirth * 1.0e-15);
    FlowView v{.device = w.device,
               .skin = &w.skin,
               .point = &w.point,
               .basis = &w.frames,
               .film = &w.film,
               .painted = &w.painted,
               .cellStart = &w.grid->cellStart(),
               .position = &w.drops.position,
               .velocity = &w.drops.velocity,
               .id = &w.drops.id,
               .motion = &w.motion,
               .slots = w.count(),
               .largestRadius = std::max({static_cast<float>(contactRadius(meanAngle(w.params)) * std::cbrt(largest)),
                                          static_cast<float>(kFilmRadius) * w.params.filmReach, w.params.brimWidth}),
               .moved = w.moves,
               .steps = w.steps,
               .onLayout = w.thesis.has_value()};
    w.grid->fill(v.grid);
    return v;
}

std::vector<float> SurfaceFlow::film(uint32_t triangle) const {
    const Impl& w = *impl_;
    const uint32_t first = w.firstCell[triangle], cells = w.firstCell[triangle + 1] - first;
    std::vector<uint32_t> volume(cells);
    w.device->read(w.film, std::as_writable_bytes(std::span(volume)), first * sizeof(uint32_t));
    vec4 frame;
    w.device->read(w.frames, std::as_writable_bytes(std::span(&frame, 1)), 5 * size_t{triangle} * sizeof(vec4));
    std::vector<float> thickness;
    thickness.reserve(cells);
    for (const uint32_t v : volume) thickness.push_back(static_cast<float>(v * 1.0e-15 * cells / std::max(double{frame.w}, 1.0e-30)));
    return thickness;
}

SurfaceFlow::Ledger SurfaceFlow::ledger() const {
    Impl& w = *impl_;
    w.device->finish();
    w.device->poll();
    Ledger l{.added = w.added,
             .left = w.reports->left,
             .evaporated = w.reports->evaporated,
             .refused = w.reports->refused,
             .merges = w.reports->merges,
             .handed = w.reports->left - leaving()};
    const auto state = w.device->readAll<uint32_t>(w.drop, size_t{w.count()} * DROP_UINTS);
    for (size_t k = 0; k < w.count(); ++k) l.drops += state[k * DROP_UINTS + DROP_VOLUME];
    for (const FlowBirth& b : w.births) l.drops += b.volume;  // with the next step
    for (const uint32_t v : w.device->readAll<uint32_t>(w.film, w.firstCell.back())) l.film += v;
    return l;
}

}  // namespace rivulet
