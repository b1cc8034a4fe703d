// Transform: where a thing is, from plain numbers.
#pragma once

#include <glm/ext/matrix_transform.hpp>

#include "engine/core/math.h"

namespace rivulet {

// Scaled, then turned about x, then y, then z, then moved.
struct Transform {
    vec3 position{0.0F};  // m
    vec3 rotation{0.0F};  // deg
    float scale = 1.0F;

    mat4 matrix() const {
        mat4 m = glm::translate(mat4(1.0F), position);
        vec3 angle = rotation * (kPi / 180.0F);
        m = glm::rotate(m, angle.z, vec3(0, 0, 1));
        m = glm::rotate(m, angle.y, vec3(0, 1, 0));
        m = glm::rotate(m, angle.x, vec3(1, 0, 0));
        return glm::scale(m, vec3(scale));
    }

    // Object -> world such that the longest side of `bounds` becomes `size` (m, > 0) and their centre, after turning, is at `position`.
    static mat4 fitted(const Bounds& bounds, float size, const vec3& position, const vec3& rotation) {
        vec3 extent = bounds.size();
        float longest = std::max(extent.x, std::max(extent.y, extent.z));
        Transform turned{position, rotation, longest > 0.0F ? size / longest : 1.0F};
        return glm::translate(turned.matrix(), -bounds.centre());
    }
};

inline vec3 transformPoint(const mat4& m, const vec3& p) { return vec3(m * vec4(p, 1.0F)); }

// The bounds of a box's eight corners, transformed.
inline Bounds transformBounds(const mat4& m, const Bounds& b) {
    Bounds out;
    if (b.empty()) return out;
    for (int k = 0; k < 8; ++k)
        out.add(
            transformPoint(m, vec3((k & 1) != 0 ? b.max.x : b.min.x, (k & 2) != 0 ? b.max.y : b.min.y, (k & 4) != 0 ? b.max.z : b.min.z)));
    return out;
}

}  // namespace rivulet
