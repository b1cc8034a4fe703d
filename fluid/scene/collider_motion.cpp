#include "fluid/scene/collider_motion.h"

#include <algorithm>
#include <cmath>

namespace rivulet {

namespace {

constexpr double kTurn = 6.283185307179586;

float smooth(double t) {
    const double s = std::clamp(t, 0.0, 1.0);
    return static_cast<float>(s * s * (3 - 2 * s));
}

quat turn(const vec3& degrees) {
    const vec3 r = degrees * (kPi / 180.0F);
    return glm::angleAxis(r.z, vec3(0, 0, 1)) * glm::angleAxis(r.y, vec3(0, 1, 0)) * glm::angleAxis(r.x, vec3(1, 0, 0));
}

// The keys' place at a time. Angles are mixed as they were written, so that a whole turn is a turn.
ColliderKey keyAt(std::span<const ColliderKey> keys, double time) {
    if (keys.empty()) return {};
    const auto after = std::find_if(keys.begin(), keys.end(), [&](const ColliderKey& k) { return k.time > time; });
    if (after == keys.begin()) return keys.front();
    if (after == keys.end()) return keys.back();
    const ColliderKey &a = *(after - 1), &b = *after;
    const float share = smooth((time - a.time) / (b.time - a.time));
    return {static_cast<float>(time), glm::mix(a.position, b.position, share), glm::mix(a.rotation, b.rotation, share)};
}

}  // namespace

Pose colliderPose(const ColliderParams& collider, double time, double turned) {
    const ColliderMotion& m = collider.motion;
    const ColliderKey key = keyAt(m.keys, time);
    const auto swing = static_cast<float>(std::sin(kTurn * std::fmod(double{m.shakeFrequency} * time, 1.0)));
    Pose pose;
    pose.position = collider.position + key.position + m.shake * swing;
    pose.rotation = turn(key.rotation);
    if (turned != 0) {
        const auto angle = static_cast<float>(std::fmod(turned, 360.0) / 360.0 * kTurn);
        pose.rotation = pose.rotation * glm::angleAxis(angle, glm::normalize(m.axis));
    }
    pose.rotation = glm::normalize(pose.rotation);
    return pose;
}

mat4 matrixOf(const Pose& pose) {
    mat4 m = glm::mat4_cast(pose.rotation);
    m[3] = vec4(pose.position, 1.0F);
    return m;
}

void waveShape(const ColliderWave& wave, std::span<const vec3> rest, double time, std::vector<vec3>& shape) {
    const vec3 along = glm::normalize(wave.along), lift = glm::normalize(wave.direction) * wave.amplitude * smooth(time / wave.period);
    shape.resize(rest.size());
    for (size_t i = 0; i < rest.size(); ++i) {
        const double phase = double{glm::dot(along, rest[i])} / wave.length - time / wave.period;
        shape[i] = rest[i] + lift * static_cast<float>(std::sin(kTurn * (phase - std::floor(phase))));
    }
}

Bounds waveReach(const ColliderWave& wave, const Bounds& rest) {
    // A little more on every side, for what floats round.
    const vec3 lift =
        glm::abs(glm::normalize(wave.direction)) * wave.amplitude + vec3(1.0e-3F * (wave.amplitude + glm::length(rest.size())));
    Bounds reach = rest;
    reach.min -= lift;
    reach.max += lift;
    return reach;
}

}  // namespace rivulet
