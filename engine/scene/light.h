// Light: one directional light, and the projection of its shadow map.
#pragma once

#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>

#include "engine/core/math.h"

namespace rivulet {

struct Light {
    vec3 direction{0.4F, 0.8F, 0.45F};  // towards the light; any length but 0
    vec3 colour{3.0F};                  // linear RGB radiance

    // World -> the light's clip space: an orthographic box around the sphere around `bounds` (m, not empty). Depth 0 is nearest the light.
    mat4 projection(const Bounds& bounds) const {
        vec3 towards = glm::normalize(direction);
        float radius = std::max(0.5F * glm::length(bounds.size()), 1e-3F);
        vec3 up = std::abs(towards.y) > 0.99F ? vec3(0, 0, 1) : vec3(0, 1, 0);
        mat4 view = glm::lookAt(bounds.centre() + towards * (2.0F * radius), bounds.centre(), up);
        return glm::ortho(-radius, radius, -radius, radius, radius, 3.0F * radius) * view;
    }
};

}  // namespace rivulet
