#include "fluid/sim/solids/body_passes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/core/assert.h"
#include "fluid/sim/methods/method.h"
#include "fluid/sim/world/state_check.h"
#include "fluid/voxel/packed_array.h"

namespace rivulet {

namespace {

bool isSound(const BodyState& s) { return rivulet::isSound(s.pose) && isWithin(s.velocity, kMostSpeed) && isWithin(s.spin, kMostSpeed); }

constexpr float kNoBody = -1;           // of a sample
constexpr double kSecondParts = 1.0e6;  // 1/s: a load acts for longer than the inverse
bool isFinite(const dvec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

// Returns "", or the fault of the body.
std::string fault(const Body& body) {
    const BodyShape& s = body.shape;
    if (s.samples.empty()) return "has no samples on its surface";
    if (!std::all_of(s.samples.begin(), s.samples.end(), [](const vec3& p) { return isWithin(p, kMostDistance); }) || !isSound(body.state))
        return fmt::format("is not finite, or its rotation has no unit length, or it is beyond {} m or {} m/s", kMostDistance, kMostSpeed);
    if (!(s.mass >= 0) || !std::isfinite(s.mass)) return fmt::format("weighs {} kg, must weigh 0 (it never moves) or more", s.mass);
    if (!(s.volume >= 0) || !std::isfinite(s.volume)) return fmt::format("displaces {} m^3, must displace 0 or more", s.volume);
    if (!(s.sticks >= 0 && s.sticks <= 1)) return fmt::format("sticks by {}, must be between 0 (slips) and 1 (no-slip)", s.sticks);
    if (!rivulet::isFinite(s.inertia)) return "has an inertia that is not finite";
    if (s.mass > 0 && !(s.inertia.x > 0 && s.inertia.y > 0 && s.inertia.z > 0))
        return "has a mass but no inertia: give it a shape with a volume, or a mass of 0";
    return "";
}

std::vector<float> volumesOf(const Body& body, const FluidParams& params) {
    return body.meetsWater ? sampleVolumes(body.shape.samples, params) : std::vector<float>();
}

}  // namespace

uint32_t BodyPasses::samplesOf(const Body& body) {
    return body.meetsWater ? static_cast<uint32_t>(std::min<size_t>(body.shape.samples.size(), UINT32_MAX)) : 0;
}

bool BodyPasses::anyMeets() const {
    return std::ranges::any_of(bodies_, [](const Body& b) { return b.meetsWater; });
}

Result<BodyPasses> BodyPasses::create(Device& device, std::span<const Body> bodies, const BodyHost& host, const FluidParams& params,
                                      const PairTraits& traits) {
    BodyPasses b;
    b.device_ = &device;
    b.reserve(bodies.size());
    for (size_t k = 0; k < bodies.size(); ++k) {
        if (const std::string wrong = fault(bodies[k]); !wrong.empty()) return badInput(fmt::format("body {} {}", k, wrong));
        b.append(bodies[k], static_cast<uint32_t>(k), b.sampleCount_, volumesOf(bodies[k], params));
        b.sampleCount_ += b.samplesOf(k);
    }
    b.filter_ = BodyLoads(bodies, params);
    b.startCount_ = bodies.size();
    if (params.maxBodySamples > 0) {
        const auto room = static_cast<uint32_t>(params.maxBodySamples);
        if (room < b.sampleCount_)
            return badInput(fmt::format("fluid.bodies.maxSamples is {}, but the bodies at the start have {} samples: increase it, or set 0",
                                        room, b.sampleCount_));
        b.sampleCount_ = room;
    }
    if ((host.advance == nullptr) != (host.reset == nullptr))
        return badInput("the host of the bodies has one of the functions advance and reset: give it both, or none");
    if ((host.added == nullptr) != (host.removed == nullptr))
        return badInput("the host of the bodies has one of the functions added and removed: give it both, or none");
    if ((host.contacts == nullptr) != (host.passed == nullptr))
        return badInput("the host of the bodies has one of the functions contacts and passed: give it both, or none");
    if (host.contacts == nullptr && (host.pulls != nullptr || host.predict != nullptr))
        return badInput("the host of the bodies has a function pulls or predict but no function contacts: give it contacts, too, or none");
    if (host.pulls != nullptr && host.predict == nullptr)
        return badInput("the host of the bodies has a function pulls but no function predict: give it both, or only predict");
    b.host_ = host;
    if (host.advance == nullptr) {
        b.free_ = std::make_shared<FreeBodies>(bodies);
        b.host_ = b.free_->host();
    }
    b.spacing_ = params.spacing;
    b.mayBeAhead_ = device.backend() != Backend::cpu && b.host_.contacts != nullptr;
    if (bodies.empty() && b.sampleCount_ == 0) return b;  // only bodies that the water does not meet can be added
    b.sampleCount_ = std::max(b.sampleCount_, 1U);        // what follows has room for them
    b.friction_ = methodOf(params).doesViscosity;
    std::vector<Define> cubic, periodic, push;
    if (b.friction_ && params.kernel == "cubic_spline") cubic.push_back({"CUBIC", "1"});
    if (glm::any(traits.periodic)) periodic.push_back({"PERIODIC", "1"});
    push = cubic;
    if (b.friction_) push.push_back({"FRICTION", "1"});
    if (!traits.walls) push.push_back({"OPEN", "1"});
    if (traits.asleepRows) periodic.push_back({"SLEEP", "1"});
    push.insert(push.end(), periodic.begin(), periodic.end());
    cubic.insert(cubic.end(), periodic.begin(), periodic.end());
    struct Wanted {
        Kernel* kernel;
        const char* path;
        std::span<const Define> defines;
    };
    for (const Wanted& w : {Wanted{&b.place_, "fluid/solids/place_samples", {}}, Wanted{&b.index_, "fluid/solids/index_samples", {}},
                            Wanted{&b.wetSamples_, "fluid/solids/wet_samples", cubic}, Wanted{&b.push_, "fluid/solids/push_samples", push},
                            Wanted{&b.sumLoads_, "fluid/solids/sum_loads", {}}}) {
        Result<Kernel> found = device.kernel(w.path, w.defines);
        if (!found) return found.error();
        *w.kernel = *found;
    }
    if (b.mayBeAhead_) {
        Result<Kernel> found = device.kernel("fluid/solids/advance_bodies");
        if (!found) return found.error();
        b.advance_ = *found;
        const Define group{"LOCAL_SIZE", std::to_string(TOUCHING_GROUP)};
        Result<Kernel> touch = device.kernel("fluid/solids/advance_touching", std::span(&group, 1));
        if (!touch) return touch.error();
        b.touch_ = *touch;
    }
    return b;
}

void BodyPasses::append(Body body, uint32_t id, uint32_t first, std::vector<float> volumes) {
    float reach = 0;
    for (const vec3& p : body.shape.samples) reach = std::max(reach, glm::length(p));
    states_.push_back(body.state);
    bodies_.push_back(std::move(body));
    volumes_.push_back(std::move(volumes));
    reach_.push_back(reach);
    loads_.emplace_back();
    first_.push_back(first);
    ids_.push_back(id);
    nextId_ = std::max(nextId_, id + 1);
}

void BodyPasses::reserve(size_t bodies) {
    states_.reserve(bodies);
    bodies_.reserve(bodies);
    volumes_.reserve(bodies);
    reach_.reserve(bodies);
    loads_.reserve(bodies);
    first_.reserve(bodies);
    ids_.reserve(bodies);
    uploaded_.reserve(bodies);
}

// Memory of the device for as many bodies.
Status BodyPasses::makeRoom(size_t bodies) {
    if (bodies <= room_) return ok();
    Result<Buffer> rows = device_->allocate(bodies * LOAD_THREADS * sizeof(LoadRow));
    if (!rows) return rows.error();
    Result<Buffer> on = device_->allocate(bodies * sizeof(DeviceBody));
    if (!on) return on.error();
    Result<Buffer> motions = device_->allocate(mayBeAhead_ ? bodies * sizeof(BodyMotion) : 0);
    if (!motions) return motions.error();
    rows_ = std::move(*rows);
    deviceBodies_ = std::move(*on);
    motions_ = std::move(*motions);
    room_ = bodies;
    return ok();
}

Status BodyPasses::allocate(uint32_t slots) {
    if (sampleCount_ == 0) return ok();
    const size_t n = sampleCount_;
    for (const auto& [buffer, bytes] : {std::pair(&own_, n * sizeof(vec4)), std::pair(&arm_, n * sizeof(vec4)),
                                        std::pair(&slotOf_, n * sizeof(uint32_t)), std::pair(&wet_, size_t{slots} * sizeof(float))}) {
        Result<Buffer> made = device_->allocate(bytes);
        if (!made) return made.error();
        *buffer = std::move(*made);
    }
    if (Status room = makeRoom(std::max<size_t>(bodies_.size(), 1)); !room) return room;
    ownRows_.resize(n);
    matterRows_.resize(n);
    upload();
    return ok();
}

// Allocates nothing.
void BodyPasses::upload() {
    std::ranges::fill(ownRows_, vec4(vec3(0.0F), kNoBody));
    uploaded_.assign(bodies_.size(), {});
    if (sampleCount_ == 0) return;
    for (size_t k = 0; k < bodies_.size(); ++k) {
        DeviceBody& d = uploaded_[k];
        d.firstSample = first_[k];
        d.endSample = first_[k] + samplesOf(k);
        d.bodyCount = static_cast<uint32_t>(bodies_.size());
        for (uint32_t s = d.firstSample; s < d.endSample; ++s)
            ownRows_[s] = vec4(bodies_[k].shape.samples[s - d.firstSample], static_cast<float>(k));
    }
    device_->writeAll<vec4>(own_, ownRows_);
    fillMatter(first_, matterRows_);
}

std::vector<uint32_t> BodyPasses::packed() const {
    std::vector<uint32_t> first;
    first.reserve(bodies_.size());
    uint32_t at = 0;
    for (size_t k = 0; k < bodies_.size(); ++k) {
        first.push_back(at);
        at += samplesOf(k);
    }
    return first;
}

Status BodyPasses::check(const Body& body) {
    const std::string wrong = fault(body);
    return wrong.empty() ? ok() : Status(badInput("the body " + wrong));
}

Status BodyPasses::add(const Body& body, uint32_t id, const FluidParams& params) {
    if (Status sound = check(body); !sound) return sound;
    const uint32_t count = samplesOf(body);
    uint32_t held = 0;
    for (size_t k = 0; k < bodies_.size(); ++k) held += samplesOf(k);
    if (count > sampleCount_ - held)
        return badInput(
            fmt::format("the body has {} samples, and there is room for {}: create the world with fluid.bodies.maxSamples of at least {}",
                        count, sampleCount_ - held, uint64_t{held} + count));
    if (std::ranges::find(ids_, id) != ids_.end() || id == UINT32_MAX) return badInput(fmt::format("there is a body {} already", id));
    if (host_.added == nullptr) return badInput("the host of the bodies has no function added: it cannot learn of another body");
    // The first gap that is long enough; else the others move together.
    std::vector<size_t> order(bodies_.size());
    for (size_t k = 0; k < order.size(); ++k) order[k] = k;
    std::ranges::sort(order, {}, [&](size_t k) { return first_[k]; });
    uint32_t at = 0;
    for (const size_t k : order) {
        if (first_[k] - at >= count) break;
        at = first_[k] + samplesOf(k);
    }
    const bool fits = sampleCount_ - at >= count;
    // All that may fail comes before anything changes.
    Body copy = body;
    std::vector<float> volumes = volumesOf(body, params);
    BodyLoads filter = filter_;
    filter.add(body, params);
    std::vector<uint32_t> moved = fits ? first_ : packed();
    stay();  // makeRoom() drops the states on the device: even if something fails now, they are written again
    if (Status room = makeRoom(bodies_.size() < room_ ? room_ : std::max<size_t>(2 * room_, 1)); !room) return room;
    reserve(room_);
    moved.reserve(room_);
    host_.added(host_.self, id, body);
    filter_ = std::move(filter);
    first_ = std::move(moved);
    append(std::move(copy), id, fits ? at : held, std::move(volumes));
    upload();
    return ok();
}

Status BodyPasses::remove(size_t body) {
    if (host_.removed == nullptr) return badInput("the host of the bodies has no function removed: it cannot learn that a body is gone");
    host_.removed(host_.self, ids_[body], body);
    stay();
    const auto drop = [at = static_cast<std::ptrdiff_t>(body)](auto& all) { all.erase(all.begin() + at); };
    drop(bodies_);
    drop(volumes_);
    drop(reach_);
    drop(states_);
    drop(loads_);
    drop(first_);
    drop(ids_);
    if (body < startCount_) --startCount_;
    filter_.remove(body);
    misled_.reset();
    upload();
    return ok();
}

Bounds BodyPasses::boundsOf(size_t body) const {
    const vec3 reach(reach_[body]), at = states_[body].pose.position;
    return {at - reach, at + reach};
}

bool BodyPasses::inside(size_t body, const vec3& p, float spacing) const {
    if (!bodies_[body].shape.distance || !bodies_[body].meetsWater) return false;
    const vec3 own = states_[body].pose.toOwn(p);
    return glm::length(own) < reach_[body] + spacing && bodies_[body].shape.distance(own) < 0;
}

bool BodyPasses::insideAdded(const vec3& p, float spacing) const {
    for (size_t k = startCount_; k < bodies_.size(); ++k)
        if (inside(k, p, spacing)) return true;
    return false;
}

bool BodyPasses::maySpawn(const vec3& p, float spacing, float near) const {
    for (size_t k = 0; k < bodies_.size(); ++k) {
        if (!bodies_[k].shape.distance || !bodies_[k].meetsWater) continue;
        const vec3 own = states_[k].pose.toOwn(p);
        // A hair less than where it would rest, so that a lattice beside a body is not lost to rounding.
        if (glm::length(own) < reach_[k] + spacing && bodies_[k].shape.distance(own) < 0.499F * near * spacing) return false;
    }
    return true;
}

std::vector<vec4> BodyPasses::matter(std::span<const uint32_t> first) const {
    std::vector<vec4> rows(sampleCount_);
    fillMatter(first, rows);
    return rows;
}

void BodyPasses::fillMatter(std::span<const uint32_t> first, std::span<vec4> rows) const {
    std::ranges::fill(rows, vec4(0.0F, 0.0F, 0.0F, -1.0F));
    // Fluid beside the surface is half a spacing off it, the samples are half a spacing behind it: what a sample drags with is twice as
    // fast against the fluid as the surface is (Adami et al. 2012).
    constexpr float kMirrored = 2;
    for (size_t k = 0; k < bodies_.size(); ++k)
        for (size_t n = 0; n < volumes_[k].size(); ++n)
            rows[first[k] + n] = vec4(volumes_[k][n], 0.0F, kMirrored * bodies_[k].shape.sticks, -1.0F - static_cast<float>(k));
}

bool BodyPasses::movedBy(size_t body, const Pose& from, float way) const {
    const Pose& to = states_[body].pose;
    const BodyShape& shape = bodies_[body].shape;
    if (!bodies_[body].meetsWater) return false;
    // The chord of the turn at the farthest sample: |q - r| of unit quaternions is 2 sin(angle / 4).
    const float turn = std::min(glm::length(to.rotation - from.rotation), glm::length(to.rotation + from.rotation));
    if (glm::length(to.position - from.position) + 2.0F * turn * reach_[body] <= way) return false;
    return std::ranges::any_of(shape.samples, [&](const vec3& own) {
        const vec3 then = from.toOwn(to.toWorld(own));
        return (shape.distance ? std::abs(shape.distance(then) - shape.distance(own)) : glm::length(then - own)) > way;
    });
}

float BodyPasses::fastest() const {
    float speed = 0;
    for (size_t k = 0; k < states_.size(); ++k) {
        if (!bodies_[k].meetsWater) continue;
        float own = glm::length(states_[k].velocity) + glm::length(states_[k].spin) * reach_[k];
        if (isAhead()) own += late_->forecast.gain(k, time_);
        speed = std::max(speed, own);
    }
    return speed;
}

void BodyPasses::place(const StepParams& step, Particles& particles) {
    if (sampleCount_ == 0) return;
    if (!ahead_) writeStates();
    device_->run(place_, step, {&particles.id, &own_, &deviceBodies_, &arm_, &particles.positionNext, &particles.velocityNext},
                 step.awakeSlots);
}

void BodyPasses::index(const StepParams& step, const NeighborGrid& grid, Particles& particles) {
    if (!any() || sampleCount_ == 0) return;
    device_->run(index_, step, {&grid.cellStart(), &particles.id, &slotOf_, &wet_, &particles.acceleration}, sampleCount_);
    device_->run(wetSamples_, step, {&grid.neighbors(), &particles.position, &wet_}, grid.sampleThreads());
}

void BodyPasses::push(const StepParams& step, const NeighborGrid& grid, Particles& particles, const Buffer& position,
                      const Buffer& pressures, float scale, const vec3& weight) {
    if (!any() || sampleCount_ == 0) return;
    StepParams s = step;
    s.sampleScale = scale;
    s.force = vec4(weight, 0.0F);
    if (friction_)
        device_->run(push_, s,
                     {&grid.neighbors(), &particles.position, &position, &pressures, &particles.matter, &particles.acceleration,
                      &particles.nearWalls, &particles.velocity},
                     grid.sampleThreads());
    else
        device_->run(push_, s,
                     {&grid.neighbors(), &particles.position, &position, &pressures, &particles.matter, &particles.acceleration,
                      &particles.nearWalls},
                     grid.sampleThreads());
}

void BodyPasses::advance(const StepParams& step, Particles& particles, double seconds) {
    if (!any()) return;
    const size_t bodies = bodies_.size();
    const bool meets = anyMeets();
    if (meets)
        device_->run(sumLoads_, step, {&slotOf_, &particles.acceleration, &wet_, &arm_, &deviceBodies_, &rows_},
                     static_cast<uint32_t>(bodies) * LOAD_THREADS);
    if (ahead_) {
        moveOnDevice(step);
        host_.passed(host_.self, seconds);
        time_ += seconds;
        states_ = late_->forecast.at(time_);
        return;
    }
    time_ += seconds;
    if (meets && device_->backend() != Backend::cpu) ++waits_;
    const std::vector<LoadRow> rows = meets ? device_->readAll<LoadRow>(rows_, bodies * LOAD_THREADS) : std::vector<LoadRow>();
    for (size_t k = 0; k < bodies; ++k) {
        if (!bodies_[k].meetsWater) continue;
        dvec3 force(0.0), torque(0.0);
        double wet = 0;
        for (size_t t = k * LOAD_THREADS; t < (k + 1) * LOAD_THREADS; ++t) {
            force += dvec3(rows[t].force);
            torque += dvec3(rows[t].torque);
            wet += double{rows[t].force.w};
        }
        // What is not finite moves nothing: the particles it comes from are counted as lost.
        if (!isFinite(force) || !isFinite(torque) || !std::isfinite(wet)) {
            force = torque = dvec3(0.0);
            wet = 0;
        }
        loads_[k] = filter_.transfer(k, force, torque, wet / static_cast<double>(bodies_[k].shape.samples.size()), seconds);
    }
    if (late_)
        for (size_t k = 0; k < bodies; ++k) {
            pushed_[k].force += loads_[k].force * seconds;
            pushed_[k].torque += loads_[k].torque * seconds;
        }
    std::vector<BodyState> next = states_;
    host_.advance(host_.self, loads_, vec3(step.gravity), seconds, next);
    for (size_t k = 0; k < bodies; ++k) {
        if (isSound(next[k]))
            states_[k] = next[k];
        else
            misled_ = k;
    }
}

std::vector<Pose> BodyPasses::starts() const {
    std::vector<Pose> poses;
    poses.reserve(bodies_.size());
    for (const Body& body : bodies_) poses.push_back(body.state.pose);
    return poses;
}

void BodyPasses::reset() {
    for (size_t k = 0; k < bodies_.size(); ++k) states_[k] = bodies_[k].state;
    std::fill(loads_.begin(), loads_.end(), BodyLoad{});
    filter_.reset();
    stay();
    if (any()) host_.reset(host_.self, states_);
}

Status BodyPasses::savable() const {
    if (!any() || host_.remembersNothing || (host_.save != nullptr && host_.restore != nullptr)) return ok();
    return failed("this host of bodies does not say what it remembers of them: a world with it cannot be saved or resumed");
}

uint64_t BodyPasses::shapesHash() const {
    uint64_t hash = 0;
    for (const Body& b : bodies_) {
        const float numbers[] = {b.shape.mass, b.shape.inertia.x, b.shape.inertia.y, b.shape.inertia.z, b.shape.volume, b.shape.sticks};
        hash = checksum(std::as_bytes(std::span(numbers)), hash);
        hash = checksum(std::as_bytes(std::span(b.shape.samples)), hash);
    }
    return hash;
}

void BodyPasses::save(WorldState& state) const {
    if (!any()) return;
    const uint64_t numbers[] = {bodies_.size(), shapesHash()};
    state.put<uint64_t>("bodies.numbers", numbers);
    state.put<BodyState>("bodies.states", states_);
    state.put<BodyLoad>("bodies.loads", loads_);
    if (first_ != packed()) state.put<uint32_t>("bodies.first", first_);
    if (host_.save != nullptr) state.putBytes("bodies.host", host_.save(host_.self));
}

Result<BodyPasses::Saved> BodyPasses::take(WorldState& state) const {
    if (!any()) return Saved{};
    Result<std::vector<uint64_t>> numbers = state.take<uint64_t>("bodies.numbers", 2);
    if (!numbers) return numbers.error();
    if ((*numbers)[0] != bodies_.size())
        return badInput(fmt::format("the state was saved with {} bodies, this scene has {}", (*numbers)[0], bodies_.size()));
    if ((*numbers)[1] != shapesHash())
        return badInput("the state was saved with other bodies: a shape, a mesh or a mass is not what it was");
    Result<std::vector<BodyState>> states = state.take<BodyState>("bodies.states", bodies_.size());
    if (!states) return states.error();
    Result<std::vector<BodyLoad>> loads = state.take<BodyLoad>("bodies.loads", bodies_.size());
    if (!loads) return loads.error();
    for (size_t k = 0; k < bodies_.size(); ++k) {
        if (!isSound((*states)[k]))
            return badInput(
                fmt::format("section bodies.states of the saved state has an invalid place or motion of body {}: save it again", k));
        // What a load would make of the body's speed.
        const BodyLoad& l = (*loads)[k];
        const BodyShape& shape = bodies_[k].shape;
        const double mass = shape.mass > 0 ? double{shape.mass} : 1,
                     inertia = shape.mass > 0 ? double{std::min({shape.inertia.x, shape.inertia.y, shape.inertia.z})} : 1;
        const auto within = [](const dvec3& v, double most) { return glm::length(v) <= most; };
        if (!within(l.force, mass * double{kMostSpeed} * kSecondParts) || !within(l.torque, inertia * double{kMostSpeed} * kSecondParts) ||
            !within(l.pendingImpulse, mass * double{kMostSpeed}) || !within(l.pendingAngularImpulse, inertia * double{kMostSpeed}))
            return badInput(fmt::format("section bodies.loads of the saved state has an impossible load on body {}: save it again", k));
    }
    Saved saved{std::move(*states), std::move(*loads), {}, packed()};
    if (state.sections().contains("bodies.first")) {
        Result<std::vector<uint32_t>> first = state.take<uint32_t>("bodies.first", bodies_.size());
        if (!first) return first.error();
        std::vector<bool> held(sampleCount_);
        for (size_t k = 0; k < bodies_.size(); ++k)
            for (uint32_t s = 0; s < samplesOf(k); ++s) {
                const uint64_t at = uint64_t{(*first)[k]} + s;
                if (at >= sampleCount_ || held[at])
                    return badInput("section bodies.first of the saved state has samples of two bodies at one place: save it again");
                held[at] = true;
            }
        saved.first = std::move(*first);
    }
    if (host_.save != nullptr) {
        Result<WorldState::Bytes> bytes = state.takeBytes("bodies.host");
        if (!bytes) return bytes.error();
        saved.host = std::move(*bytes);
    }
    return saved;
}

Status BodyPasses::restore(const Saved& saved) {
    if (!any()) return ok();
    if (host_.save != nullptr)
        if (Status done = host_.restore(host_.self, saved.host, saved.states); !done) return done;
    states_ = saved.states;
    loads_ = saved.loads;
    filter_.restore(loads_);
    stay();
    if (first_ != saved.first) {
        first_ = saved.first;
        upload();
    }
    return ok();
}

}  // namespace rivulet
