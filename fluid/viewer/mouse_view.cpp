#include "fluid/viewer/mouse_view.h"

#include <algorithm>
#include <cmath>

#include "fluid/session/scene_renderer.h"
#include "fluid/viewer/manipulator.h"

namespace rivulet {

bool moveCamera(const InputEvents& input, const Bounds& bounds, CameraParams& params) {
    vec2 size(std::max(input.size.x, 1), std::max(input.size.y, 1));
    vec2 moved = input.mouseDelta / size.y;
    bool turns = input.down(MouseButton::left), pans = input.down(MouseButton::right) || input.down(MouseButton::middle);
    // Movement before the press is no drag.
    const bool pressed = input.pressed(MouseButton::left) || input.pressed(MouseButton::right) || input.pressed(MouseButton::middle);
    bool any = (turns || pans) && !pressed && moved != vec2(0.0F);
    if (!any) turns = pans = false;
    if (!any && input.wheel.y == 0) return false;
    Camera camera = cameraOf(params, bounds);
    OrbitCamera orbit = OrbitCamera::from(camera);
    constexpr float kDegreesAcross = 200;  // of a drag over the window's height
    if (turns) orbit.orbit(-kDegreesAcross * moved.x, kDegreesAcross * moved.y);
    if (pans && !turns) {
        float across = 2 * std::tan(0.5F * camera.fieldOfView * kPi / 180.0F);  // in distances: the point under the mouse stays under it
        orbit.pan(-across * moved.x, across * moved.y);
    }
    if (input.wheel.y != 0) orbit.zoom(input.wheel.y);
    constexpr float kNearest = 1e-3F, kFarthest = 1e4F;  // m
    orbit.distance = std::clamp(orbit.distance, kNearest, kFarthest);
    orbit.apply(camera);
    if (!isFinite(camera.position) || !isFinite(camera.target)) return false;
    params.position = camera.position;
    params.target = camera.target;
    return true;
}

void SkinClick::take(const InputEvents& input, const CameraParams& camera, Session& session) {
    constexpr int kLeft = static_cast<int>(MouseButton::left);
    constexpr float kStill = 4;  // px: a longer way is a drag
    if (input.buttonPressed[kLeft]) pressedAt_ = input.mouse;
    if (!input.buttonReleased[kLeft] || glm::distance(input.mouse, pressedAt_) > kStill || session.flows().empty()) return;
    if (input.size.x <= 0 || input.size.y <= 0) return;
    const ViewRay ray = rayThrough(cameraOf(camera, session.bounds()), input.mouse, vec2(input.size));
    constexpr uint32_t kTear = 8000000;  // picolitres
    session.flows().drip(dvec3(ray.origin), dvec3(ray.direction), kTear);
}

}  // namespace rivulet
