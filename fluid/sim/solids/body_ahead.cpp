// Bodies that a GPU moves while they are free, and the host's knowledge of them.
#include <algorithm>
#include <cstring>
#include <utility>

#include "fluid/sim/solids/body_passes.h"

namespace rivulet {

namespace {

BodyState stateOf(const DeviceBody& d) {
    return {{vec3(d.position), quat(d.rotation.w, d.rotation.x, d.rotation.y, d.rotation.z)}, vec3(d.velocity), vec3(d.spin)};
}

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
                          0};
    }
    device_->write(motions_, std::as_bytes(std::span(motionRows_)));
}

void BodyPasses::stay() {
    late_.reset();
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
    late_->forecast.arrived(states_, time_);
    settled_ = true;
}

BodyRows BodyPasses::rows() const {
    if (!mayBeAhead_ || !any() || sampleCount_ == 0) return {};
    return {&deviceBodies_, static_cast<uint32_t>(bodies_.size()), ahead_};
}

std::optional<std::vector<BodyState>> BodyPasses::statesAt(double time) const { return late_ ? late_->states.at(time) : std::nullopt; }

void BodyPasses::settleNear(const vec3& p, float spacing) {
    for (size_t k = 0; k < bodies_.size() && isAhead(); ++k)
        if (const vec4& ball = motionRows_[k].ball; glm::length(p - vec3(ball)) < ball.w + reach_[k] + 2 * spacing) settle();
}

void BodyPasses::beginFrame(const vec3& gravity, double seconds, bool exact) {
    if (!mayBeAhead_ || !any() || sampleCount_ == 0) return;
    if (!late_) {
        late_ = std::make_shared<Late>(Late{BodyForecast(bodies_), std::vector<uint32_t>(bodies_.size()), {}});
        pushed_.assign(bodies_.size(), dvec3(0.0));
        pushedFrom_ = time_;
    }
    std::vector<vec4> balls;
    const auto areFree = [&] {
        balls = late_->forecast.balls(time_, time_ + seconds, glm::length(gravity));
        return host_.isFree(host_.self, balls, seconds);
    };
    if (!ahead_) {
        const double passed = time_ - pushedFrom_;
        std::vector<vec3> accelerations(bodies_.size(), vec3(0.0F));
        for (size_t k = 0; k < bodies_.size(); ++k)
            if (const double mass = bodies_[k].shape.mass; mass > 0)
                accelerations[k] = gravity + (passed > 0 ? vec3(pushed_[k] / (mass * passed)) : vec3(0.0F));
        late_->forecast.set(states_, accelerations, time_);
        std::ranges::fill(pushed_, dvec3(0.0));
        pushedFrom_ = time_;
    }
    const bool faulty = ahead_ && std::ranges::any_of(late_->faults, [](uint32_t f) { return f != 0; });
    if (exact || faulty) settle();
    for (size_t k = 0; k < bodies_.size(); ++k) {
        const bool strayed = (std::exchange(late_->faults[k], 0U) & BODY_STRAYED) != 0;
        late_->forecast.frame(k, strayed);
        if (strayed) ++strays_;
    }
    bool free = !exact && areFree();
    if (!free && isAhead()) {
        settle();
        free = !exact && areFree();
    }
    if (free) {
        writeMotions(balls);
        if (!ahead_ || faulty) writeStates();  // without faults
    }
    ahead_ = free;
}

void BodyPasses::endFrame(double time) {
    if (!ahead_) {
        if (late_) late_->states.keep(time, states_);
        return;
    }
    device_->readLater(deviceBodies_, bodies_.size() * sizeof(DeviceBody),
                       [weak = std::weak_ptr(late_), moved = time_, time](std::span<const std::byte> bytes) {
                           const std::shared_ptr<Late> late = weak.lock();
                           if (!late) return;  // the bodies have changed meanwhile
                           std::vector<DeviceBody> rows(bytes.size() / sizeof(DeviceBody));
                           std::memcpy(rows.data(), bytes.data(), bytes.size());
                           std::vector<BodyState> states;
                           states.reserve(rows.size());
                           for (const DeviceBody& d : rows) states.push_back(stateOf(d));
                           late->states.keep(time, states);
                           if (!late->forecast.arrived(states, moved)) return;
                           for (size_t k = 0; k < rows.size(); ++k) late->faults[k] |= rows[k].faults;
                       });
}

}  // namespace rivulet
