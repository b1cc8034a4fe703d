#include "fluid/viewer/pour_brush.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "fluid/viewer/manipulator.h"

namespace rivulet {

std::optional<vec3> pouredOnto(Session& session, const vec3& origin, const vec3& direction) {
    const BoxParams& box = session.scene().fluid.box;
    const vec3 way = glm::normalize(direction);
    float from = 0, to = std::numeric_limits<float>::max();
    for (int axis = 0; axis < 3; ++axis) {
        if (std::abs(way[axis]) < 1.0e-6F) {
            if (origin[axis] < box.min[axis] || origin[axis] > box.max[axis]) return std::nullopt;
            continue;
        }
        const float a = (box.min[axis] - origin[axis]) / way[axis], b = (box.max[axis] - origin[axis]) / way[axis];
        from = std::max(from, std::min(a, b));
        to = std::min(to, std::max(a, b));
    }
    if (!(from < to)) return std::nullopt;
    float nearest = to;
    const auto meets = [&](const vec3& place) {
        const float t = glm::dot(place - origin, way);
        if (t > from) nearest = std::min(nearest, t);
    };
    if (const auto solid = session.meet(origin, way)) meets(solid->place);
    const FluidRay ray{origin, way};
    if (const auto water = session.world().cast(std::span(&ray, 1)); water && (*water)[0].hit) meets((*water)[0].place);
    return origin + nearest * way;
}

bool PourBrush::take(const InputEvents& input, const Camera& camera, Session& session, bool over) {
    if (!on_) {
        at_.reset();
        if (std::exchange(pours_, false)) session.pourOnto(std::nullopt);
        return false;
    }
    const bool down = input.down(MouseButton::left);
    if (input.pressed(MouseButton::left) && !over) pours_ = true;
    if (!down) pours_ = false;
    at_.reset();
    if (!over || pours_) {
        const ViewRay ray = rayThrough(camera, input.mouse, vec2(glm::max(input.size, ivec2(1))));
        at_ = pouredOnto(session, ray.origin, ray.direction);
    }
    session.pourOnto(pours_ ? at_ : std::nullopt);
    return pours_ || (!over && (down || input.buttonReleased[0]));
}

void PourBrush::draw(const InputEvents& input, const Camera& camera, const Session& session) const {
    if (!on_ || !at_) return;
    const SceneFile& scene = session.scene();
    const EmitterParams jet = pouring(scene.pour, scene.fluid, at_);
    const vec2 size(glm::max(input.size, ivec2(1)));
    const float scale = size.x / std::max(ImGui::GetIO().DisplaySize.x, 1.0F);  // window coordinates in one of ImGui's
    const vec3 axis = glm::normalize(jet.direction), other = std::abs(axis.y) < 0.9F ? vec3(0, 1, 0) : vec3(1, 0, 0);
    const vec3 u = glm::normalize(glm::cross(other, axis)), v = glm::cross(axis, u);
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    const ImU32 colour = pours_ ? IM_COL32(160, 220, 255, 255) : IM_COL32(255, 255, 255, 190);
    const auto line = [&](const vec3& a, const vec3& b) {
        const auto from = seenAt(camera, a, size), to = seenAt(camera, b, size);
        if (from && to) list.AddLine(ImVec2(from->x / scale, from->y / scale), ImVec2(to->x / scale, to->y / scale), colour, 2);
    };
    constexpr int kCorners = 32;
    const auto corner = [&](int k) {
        const float angle = 2 * kPi * static_cast<float>(k) / kCorners;
        return jet.position + jet.radius * (std::cos(angle) * u + std::sin(angle) * v);
    };
    for (int k = 0; k < kCorners; ++k) line(corner(k), corner(k + 1));
    line(jet.position, *at_);
}

}  // namespace rivulet
