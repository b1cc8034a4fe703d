// Bodies that a GPU moves, and the host's knowledge of them: it finds their contacts with states that it expects.
#include <algorithm>
#include <cstring>
#include <utility>

#include "engine/core/assert.h"
#include "fluid/sim/solids/body_passes.h"

namespace rivulet {

namespace {

BodyState stateOf(const DeviceBody& d) {
    return {{vec3(d.position), quat(d.rotation.w, d.rotation.x, d.rotation.y, d.rotation.z)}, vec3(d.velocity), vec3(d.spin)};
}

// The fluid's mean loads in the `seconds` that a frame of theirs has been.
std::vector<BodyLoad> meanLoads(std::span<const DeviceBody> rows, double seconds) {
    std::vector<BodyLoad> loads(rows.size());
    for (size_t k = 0; k < rows.size() && seconds > 0; ++k)
        loads[k] = {dvec3(vec3(rows[k].pushed)) / seconds, dvec3(vec3(rows[k].pushedAngular)) / seconds, {}, {}};
    return loads;
}

constexpr float kSame = 0.5F;     // spacings: a contact that has moved no further from one frame to the next is the same
constexpr double kCrowded = 0.5;  // s: where too many touch, how long nothing is searched

}  // namespace

void BodyPasses::writeStates() {
    for (size_t k = 0; k < states_.size(); ++k) {
        const BodyState& s = states_[k];
        const quat& q = s.pose.rotation;
        DeviceBody& d = uploaded_[k];
        d.position = vec4(s.pose.position, 0.0F);
        d.rotation = vec4(q.x, q.y, q.z, q.w);
        d.velocity = vec4(s.velocity, 0.0F);
        d.spin = vec4(s.spin, 0.0F);
        d.pendingImpulse = vec4(vec3(loads_[k].pendingImpulse), 0.0F);
        d.pendingAngularImpulse = vec4(vec3(loads_[k].pendingAngularImpulse), 0.0F);
    }
    if (any()) device_->write(deviceBodies_, std::as_bytes(std::span(uploaded_)));
}

void BodyPasses::writeMotions(std::span<const vec4> balls) {
    motionRows_.resize(bodies_.size());
    for (size_t k = 0; k < bodies_.size(); ++k) {
        const BodyShape& s = bodies_[k].shape;
        motionRows_[k] = {vec4(s.inertia, s.mass),
                          balls[k],
                          static_cast<float>(filter_.added(k)),
                          static_cast<float>(samplesOf(k)),
                          static_cast<uint32_t>(bodies_.size()),
                          touching_.slots.empty() ? NO_SLOT : touching_.slots[k],
                          vec4(0.0F),
                          vec4(0.0F)};
    }
    for (const BodyPull& p : pulls_) {
        ASSERT(p.body < bodies_.size(), "a pull is of a body among the states");
        motionRows_[p.body].grip = vec4(p.at, p.rate);
        motionRows_[p.body].hand = vec4(p.to, p.most);
    }
    device_->write(motions_, std::as_bytes(std::span(motionRows_)));
}

void BodyPasses::stay() {
    late_.reset();
    touching_ = {};
    ahead_ = false;
    settled_ = true;
}

void BodyPasses::take(std::span<const DeviceBody> rows) {
    for (size_t k = 0; k < bodies_.size(); ++k) {
        const DeviceBody& d = rows[k];
        states_[k] = stateOf(d);
        loads_[k] = {dvec3(vec3(d.force)), dvec3(vec3(d.torque)), dvec3(vec3(d.pendingImpulse)), dvec3(vec3(d.pendingAngularImpulse))};
        if ((d.faults & BODY_MISLED) != 0) misled_ = k;
    }
    filter_.restore(loads_);
}

void BodyPasses::settle() {
    if (!isAhead()) return;
    ++waits_;
    const std::vector<DeviceBody> rows = device_->readAll<DeviceBody>(deviceBodies_, bodies_.size());
    if (device_->health().state == DeviceHealth::lost) return;  // the rows are zeros
    take(rows);
    for (size_t k = 0; k < rows.size(); ++k) late_->faults[k] |= rows[k].faults;
    late_->forecast.arrived(states_, meanLoads(rows, time_ - frameBegin_), time_);
    settled_ = true;
}

BodyRows BodyPasses::rows() const {
    if (!mayBeAhead_ || !any() || sampleCount_ == 0) return {};
    return {&deviceBodies_, static_cast<uint32_t>(bodies_.size()), ahead_};
}

std::optional<std::vector<BodyState>> BodyPasses::statesAt(double time) const { return late_ ? late_->states.at(time) : std::nullopt; }

bool BodyPasses::findContacts(const vec3& gravity, double seconds) {
    BodyForecast& forecast = late_->forecast;
    const double end = time_ + seconds;
    pulls_.clear();
    if (host_.pulls != nullptr) host_.pulls(host_.self, pulls_);
    if (!pulls_.empty()) late_->heldUntil = end;
    const float strength = glm::length(gravity);
    std::vector<BodyContact> found;
    const auto ask = [&](double from) {
        found.clear();
        return host_.contacts(host_.self, forecast.at(time_), forecast.balls(from, end, strength), seconds, found);
    };
    const bool held = !pulls_.empty() || forecast.time() < late_->heldUntil;
    forecast.expect(nullptr, gravity, time_, end);
    // Held by nothing and far from everything since the last report: then they have moved freely.
    if (!held && touching_.touching == 0 && !ask(forecast.time())) return false;
    if (held || touching_.touching > 0 || !found.empty()) {
        if (!held && forecast.rest())
            forecast.expectRest(end);
        else
            forecast.expect(&host_, gravity, time_, end);
        if (!ask(time_)) return false;
    }
    std::vector<bool> moves;
    moves.reserve(bodies_.size());
    for (const Body& b : bodies_) moves.push_back(b.shape.mass > 0);
    touching_ = contactRows(found, moves, late_->moved, kSame * spacing_);
    if (touching_.touching <= MOST_TOUCHING) return uploadContacts();
    late_->crowdedUntil = time_ + kCrowded;
    return false;
}

bool BodyPasses::uploadContacts() {
    if (touching_.touching == 0) return true;
    const auto holds = [&](Buffer& buffer, size_t bytes) {
        if (buffer.bytes() >= bytes && buffer.bytes() > 0) return true;
        Result<Buffer> made = device_->allocate(2 * bytes);
        if (!made) device_->forgiveFull();  // the host moves the bodies then
        if (!made) return false;
        buffer = std::move(*made);
        device_->fill(buffer, 0);
        return true;
    };
    // The first substep swaps the two: until then contactStates_ has the states of the frame before.
    if (!holds(contactStates_, late_->moved.contacts.size() * sizeof(ContactState)) ||
        !holds(contactsBefore_, touching_.contacts.size() * sizeof(ContactState)) ||
        !holds(contacts_, touching_.contacts.size() * sizeof(ContactRow)) || !holds(pairs_, touching_.pairs.size() * sizeof(ContactPair)) ||
        !holds(colours_, touching_.colours.size() * sizeof(uint32_t)))
        return false;
    device_->writeAll<ContactPair>(pairs_, touching_.pairs);
    device_->writeAll<ContactRow>(contacts_, touching_.contacts);
    device_->writeAll<uint32_t>(colours_, touching_.colours);
    return true;
}

void BodyPasses::moveOnDevice(const StepParams& step) {
    StepParams s = step;
    const bool first = std::exchange(frameBegins_, false);
    if (first) frameBegin_ = time_;
    // Impulses are forces times the length of a step.
    const double last = std::exchange(late_->step, double{step.dt});
    s.force = vec4(static_cast<float>(time_ - frameBegin_), first ? 1.0F : 0.0F, static_cast<float>(touching_.colourCount()),
                   last > 0 ? static_cast<float>(double{step.dt} / last) : 1.0F);
    if (first) {
        if (touching_.touching > 0) std::swap(contactStates_, contactsBefore_);
        late_->moved = touching_;
    }
    if (touching_.touching > 0)
        device_->run(touch_, s, {&rows_, &motions_, &deviceBodies_, &pairs_, &contacts_, &colours_, &contactStates_, &contactsBefore_},
                     TOUCHING_GROUP);
    else
        device_->run(advance_, s, {&rows_, &motions_, &deviceBodies_}, static_cast<uint32_t>(bodies_.size()));
    settled_ = false;
}

void BodyPasses::beginFrame(const vec3& gravity, double seconds) {
    if (!mayBeAhead_ || !any() || sampleCount_ == 0 || !(seconds > 0)) return;
    if (!late_) {
        late_ = std::make_shared<Late>(Late{BodyForecast(bodies_), std::vector<uint32_t>(bodies_.size()), {}});
        pushed_.assign(bodies_.size(), {});
        pushedFrom_ = time_;
    }
    frameBegins_ = true;
    if (!ahead_) {
        std::vector<BodyLoad> loads(bodies_.size());
        if (const double passed = time_ - pushedFrom_; passed > 0)
            for (size_t k = 0; k < bodies_.size(); ++k) loads[k] = {pushed_[k].force / passed, pushed_[k].torque / passed, {}, {}};
        late_->forecast.set(states_, loads, time_);
        pushed_.assign(bodies_.size(), {});
        pushedFrom_ = time_;
    }
    for (size_t k = 0; k < bodies_.size(); ++k) {
        const uint32_t faults = std::exchange(late_->faults[k], 0U);
        if ((faults & BODY_MISLED) != 0) misled_ = k;
        late_->forecast.frame(k, (faults & BODY_STRAYED) != 0);
        if ((faults & BODY_STRAYED) != 0) ++strays_;
    }
    if (time_ < late_->crowdedUntil || !findContacts(gravity, seconds)) {
        settle();
        touching_ = {};
        late_->moved = {};
        ahead_ = false;
        return;
    }
    if (isAhead()) states_ = late_->forecast.at(time_);
    writeMotions(late_->forecast.balls(time_, time_ + seconds, glm::length(gravity)));
    if (!ahead_) writeStates();
    ahead_ = true;
}

void BodyPasses::endFrame(double time) {
    if (!ahead_) {
        if (late_) late_->states.keep(time, states_);
        return;
    }
    device_->readLater(deviceBodies_, bodies_.size() * sizeof(DeviceBody),
                       [weak = std::weak_ptr(late_), moved = time_, seconds = time_ - frameBegin_, time](std::span<const std::byte> bytes) {
                           const std::shared_ptr<Late> late = weak.lock();
                           if (!late) return;  // the bodies have changed meanwhile
                           std::vector<DeviceBody> rows(bytes.size() / sizeof(DeviceBody));
                           std::memcpy(rows.data(), bytes.data(), bytes.size());
                           std::vector<BodyState> states;
                           states.reserve(rows.size());
                           for (const DeviceBody& d : rows) states.push_back(stateOf(d));
                           late->states.keep(time, states);
                           if (!late->forecast.arrived(states, meanLoads(rows, seconds), moved)) return;
                           for (size_t k = 0; k < rows.size(); ++k) late->faults[k] |= rows[k].faults;
                       });
}

}  // namespace rivulet
