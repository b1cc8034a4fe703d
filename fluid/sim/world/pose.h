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

// The straight way, and the short way round.
inline Pose between(const Pose& a, const Pose& b, double share) {
    const auto t = static_cast<float>(share);
    return {glm::mix(a.position, b.position, t), glm::normalize(glm::slerp(a.rotation, b.rotation, t))};
}

}  // namespace rivulet
