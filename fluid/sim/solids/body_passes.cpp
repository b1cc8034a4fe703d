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

}  // namespace

Result<BodyPasses> BodyPasses::create(Device& device, std::span<const Body> bodies, const BodyHost& host, const FluidParams& params,
                                      const PairTraits& traits) {
    BodyPasses b;
    b.device_ = &device;
    if (bodies.empty()) return b;
    if ((host.advance == nullptr) != (host.reset == nullptr))
        return badInput("the host of the bodies has one of the functions advance and reset: give it both, or none");
    b.bodies_.assign(bodies.begin(), bodies.end());
    for (size_t k = 0; k < bodies.size(); ++k) {
        const BodyShape& shape = bodies[k].shape;
        if (const std::string wrong = fault(bodies[k]); !wrong.empty()) return badInput(fmt::format("body {} {}", k, wrong));
        const std::vector<float> volumes = sampleVolumes(shape.samples, params);
        b.volumes_.insert(b.volumes_.end(), volumes.begin(), volumes.end());
        float reach = 0;
        for (const vec3& p : shape.samples) reach = std::max(reach, glm::length(p));
        b.reach_.push_back(reach);
        b.states_.push_back(bodies[k].state);
    }
    b.loads_.resize(bodies.size());
    b.sampleCount_ = static_cast<uint32_t>(b.volumes_.size());
    b.filter_ = BodyLoads(bodies, params);
    b.host_ = host;
    if (host.advance == nullptr) {
        b.free_ = std::make_shared<FreeBodies>(bodies);
        b.host_ = b.free_->host();
    }
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
    return b;
}

Status BodyPasses::allocate(uint32_t slots) {
    const size_t n = sampleCount_;
    for (const auto& [buffer, bytes] :
         {std::pair(&own_, n * sizeof(vec4)), std::pair(&arm_, n * sizeof(vec4)), std::pair(&slotOf_, n * sizeof(uint32_t)),
          std::pair(&wet_, size_t{slots} * sizeof(float)), std::pair(&rows_, bodies_.size() * LOAD_THREADS * sizeof(LoadRow)),
          std::pair(&deviceBodies_, bodies_.size() * sizeof(DeviceBody))}) {
        Result<Buffer> made = device_->allocate(bytes);
        if (!made) return made.error();
        *buffer = std::move(*made);
    }
    std::vector<vec4> own;
    own.reserve(n);
    uploaded_.resize(bodies_.size());
    for (size_t k = 0; k < bodies_.size(); ++k) {
        uploaded_[k].firstSample = static_cast<uint32_t>(own.size());
        for (const vec3& p : bodies_[k].shape.samples) own.emplace_back(p, static_cast<float>(k));
        uploaded_[k].endSample = static_cast<uint32_t>(own.size());
        uploaded_[k].bodyCount = static_cast<uint32_t>(bodies_.size());
    }
    device_->writeAll<vec4>(own_, own);
    return ok();
}

bool BodyPasses::maySpawn(const vec3& p, float spacing, float near) const {
    for (size_t k = 0; k < bodies_.size(); ++k) {
        if (!bodies_[k].shape.distance) continue;
        const vec3 own = states_[k].pose.toOwn(p);
        // A hair less than where it would rest, so that a lattice beside a body is not lost to rounding.
        if (glm::length(own) < reach_[k] + spacing && bodies_[k].shape.distance(own) < 0.499F * near * spacing) return false;
    }
    return true;
}

std::vector<vec4> BodyPasses::matter() const {
    std::vector<vec4> rows;
    rows.reserve(sampleCount_);
    // Fluid beside the surface is half a spacing off it, the samples are half a spacing behind it: what a sample drags with is twice as
    // fast against the fluid as the surface is (Adami et al. 2012).
    constexpr float kMirrored = 2;
    for (size_t k = 0; k < bodies_.size(); ++k)
        for (size_t n = bodies_[k].shape.samples.size(); n > 0; --n)
            rows.emplace_back(volumes_[rows.size()], 0.0F, kMirrored * bodies_[k].shape.sticks, -1.0F - static_cast<float>(k));
    return rows;
}

bool BodyPasses::movedBy(size_t body, const Pose& from, float way) const {
    const Pose& to = states_[body].pose;
    const BodyShape& shape = bodies_[body].shape;
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
    for (size_t k = 0; k < states_.size(); ++k)
        speed = std::max(speed, glm::length(states_[k].velocity) + glm::length(states_[k].spin) * reach_[k]);
    return speed;
}

void BodyPasses::place(const StepParams& step, Particles& particles) {
    if (!any()) return;
    for (size_t k = 0; k < states_.size(); ++k) {
        const BodyState& s = states_[k];
        const quat& q = s.pose.rotation;
        DeviceBody& d = uploaded_[k];
        d.position = vec4(s.pose.position, 0.0F);
        d.rotation = vec4(q.x, q.y, q.z, q.w);
        d.velocity = vec4(s.velocity, 0.0F);
        d.spin = vec4(s.spin, 0.0F);
    }
    device_->writeAll<DeviceBody>(deviceBodies_, uploaded_);
    device_->run(place_, step, {&particles.id, &own_, &deviceBodies_, &arm_, &particles.positionNext, &particles.velocityNext},
                 step.awakeSlots);
}

void BodyPasses::index(const StepParams& step, const NeighborGrid& grid, Particles& particles) {
    if (!any()) return;
    device_->run(index_, step, {&grid.cellStart(), &particles.id, &slotOf_, &wet_, &particles.acceleration}, sampleCount_);
    device_->run(wetSamples_, step, {&grid.neighbors(), &particles.position, &wet_}, grid.sampleThreads());
}

void BodyPasses::push(const StepParams& step, const NeighborGrid& grid, Particles& particles, const Buffer& position,
                      const Buffer& pressures, float scale, const vec3& weight) {
    if (!any()) return;
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
    device_->run(sumLoads_, step, {&slotOf_, &particles.acceleration, &wet_, &arm_, &deviceBodies_, &rows_},
                 static_cast<uint32_t>(bodies) * LOAD_THREADS);
    const std::vector<LoadRow> rows = device_->readAll<LoadRow>(rows_, bodies * LOAD_THREADS);
    for (size_t k = 0; k < bodies; ++k) {
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
    Saved saved{std::move(*states), std::move(*loads), {}};
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
    return ok();
}

}  // namespace rivulet
