// Pose: where a frame of its own is in the world.
#pragma once

#include "engine/core/math.h"

namespace rivulet {

// Own frame -> world.
struct Pose {
    vec3 position{0.0F};                    // m, of the frame's origin
    quat rotation{1.0F, 0.0F, 0.0F, 0.0F};  // unit
    vec3 toWorld(const vec3& p) const { return position + rotation * p; }
    vec3 toOwn(const vec3& p) const { return glm::conjugate(rotation) * (p - position); }
};

// Farther than anything in a world is from its origin (m), and faster (m/s): what is beyond is refused.
inline constexpr float kMostDistance = 1.0e6F, kMostSpeed = 1.0e6F;
inline bool isWithin(const vec3& v, float most) {
    return std::abs(v.x) <= most && std::abs(v.y) <= most && std::abs(v.z) <= most;  // false for NaN
}
// Finite, not too far, and a rotation of unit length.
inline bool isSound(const Pose& p) {
    return isWithin(p.position, kMostDistance) && std::abs(glm::dot(p.rotation, p.rotation) - 1.0F) < 1.0e-3F;
}

// The straight way, and the short way round.
inline Pose between(const Pose& a, const Pose& b, double share) {
    const auto t = static_cast<float>(share);
    return {glm::mix(a.position, b.position, t), glm::normalize(glm::slerp(a.rotation, b.rotation, t))};
}

}  // namespace rivulet
