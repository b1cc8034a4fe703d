#include "engine/scene/camera.h"

#include <algorithm>
#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>

namespace rivulet {
namespace {

vec3 directionOf(float yaw, float pitch) {
    return vec3(std::sin(yaw * kDegree) * std::cos(pitch * kDegree), std::sin(pitch * kDegree),
                std::cos(yaw * kDegree) * std::cos(pitch * kDegree));
}
}  // namespace

mat4 Camera::view() const {
    vec3 forward = target - position;
    float length = glm::length(forward);
    if (!(length > 0.0F)) forward = vec3(0, 0, -1);
    vec3 up = std::abs(forward.y) > 0.9999F * length ? vec3(0, 0, -1) : vec3(0, 1, 0);
    return glm::lookAt(position, position + forward, up);
}

mat4 Camera::projection(float widthOverHeight) const {
    return glm::perspective(fieldOfView * kDegree, widthOverHeight, nearPlane, farPlane);
}

void Camera::setPlanes(const Bounds& bounds) {
    float radius = bounds.empty() ? 1.0F : std::max(0.5F * glm::length(bounds.size()), 1e-3F);
    float away = bounds.empty() ? glm::length(target - position) : glm::length(bounds.centre() - position);
    nearPlane = std::max(0.5F * (away - radius), 0.01F * radius);
    farPlane = away + 40.0F * radius;
}

OrbitCamera OrbitCamera::from(const Camera& camera) {
    OrbitCamera orbit;
    vec3 offset = camera.position - camera.target;
    orbit.target = camera.target;
    orbit.distance = std::max(glm::length(offset), 1e-4F);
    offset /= orbit.distance;
    orbit.pitch = std::clamp(std::asin(std::clamp(offset.y, -1.0F, 1.0F)) / kDegree, -89.0F, 89.0F);
    orbit.yaw = std::atan2(offset.x, offset.z) / kDegree;
    return orbit;
}

void OrbitCamera::orbit(float yawDegrees, float pitchDegrees) {
    yaw = std::remainder(yaw + yawDegrees, 360.0F);
    pitch = std::clamp(pitch + pitchDegrees, -89.0F, 89.0F);
}

void OrbitCamera::pan(float right, float up) {
    vec3 back = directionOf(yaw, pitch);
    vec3 side = glm::normalize(glm::cross(vec3(0, 1, 0), back));
    target += (side * right + glm::cross(back, side) * up) * distance;
}

void OrbitCamera::zoom(float steps) { distance = std::clamp(distance * std::pow(0.9F, steps), 1e-3F, 1e4F); }

void OrbitCamera::frame(const Bounds& bounds, float fieldOfView, float widthOverHeight) {
    if (bounds.empty()) return;
    target = bounds.centre();
    float half = 0.5F * fieldOfView * kDegree;
    float narrow = std::min(half, std::atan(std::tan(half) * widthOverHeight));
    distance = std::max(0.5F * glm::length(bounds.size()) / std::sin(narrow), 1e-3F);
}

void OrbitCamera::apply(Camera& camera) const {
    camera.target = target;
    camera.position = target + directionOf(yaw, pitch) * distance;
}

}  // namespace rivulet
