#include "fluid/viewer/manipulator.h"

#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace rivulet {

namespace {

constexpr float kHandleReach = 9;  // px: as near to a handle a press takes it
constexpr float kStill = 4;        // px: what moved further was a drag
constexpr float kReach = 0.16F;    // of the camera's distance: how long handles are
constexpr float kRing = 0.75F;     // of that: the rings' radius
constexpr float kRadian = kPi / 180.0F;
constexpr int kCorners = 48;  // of a ring as it is drawn

constexpr std::array<vec3, 3> kAxes = {vec3(1, 0, 0), vec3(0, 1, 0), vec3(0, 0, 1)};

// A ring's corner, about axis k.
vec3 onRing(const vec3& centre, int axis, float radius, float angle) {
    const vec3 &u = kAxes[static_cast<size_t>((axis + 1) % 3)], &v = kAxes[static_cast<size_t>((axis + 2) % 3)];
    return centre + radius * (std::cos(angle) * u + std::sin(angle) * v);
}

float fromSegment(const vec2& p, const vec2& a, const vec2& b) {
    const vec2 way = b - a;
    const float length2 = glm::dot(way, way);
    const float t = length2 > 0 ? std::clamp(glm::dot(p - a, way) / length2, 0.0F, 1.0F) : 0.0F;
    return glm::distance(p, a + t * way);
}

// Where on the axis through `centre` the ray passes nearest, m; nothing: it looks along the axis.
std::optional<float> alongAxis(const ViewRay& ray, const vec3& centre, const vec3& axis) {
    const vec3 way = glm::normalize(ray.direction), off = ray.origin - centre;
    const float b = glm::dot(axis, way), c = 1 - b * b;
    if (c < 1.0e-3F) return std::nullopt;
    return (glm::dot(axis, off) - b * glm::dot(way, off)) / c;
}

// The angle about the axis at which the ray meets the plane through `centre`; nothing: it does not.
std::optional<float> aboutAxis(const ViewRay& ray, const vec3& centre, int axis) {
    const auto k = static_cast<size_t>(axis);
    const float down = glm::dot(ray.direction, kAxes[k]);
    if (std::abs(down) < 0.02F * glm::length(ray.direction)) return std::nullopt;
    const vec3 at = ray.at(glm::dot(centre - ray.origin, kAxes[k]) / down) - centre;
    return std::atan2(glm::dot(at, kAxes[(k + 2) % 3]), glm::dot(at, kAxes[(k + 1) % 3]));
}

// Degrees about x, then y, then z, of a rotation.
vec3 anglesOf(const quat& q) {
    const mat3 m = glm::mat3_cast(q);
    const float y = std::asin(std::clamp(-m[0][2], -1.0F, 1.0F));
    if (std::abs(m[0][2]) > 0.9999F) return vec3(std::atan2(-m[2][1], m[1][1]), y, 0.0F) / kRadian;
    return vec3(std::atan2(m[1][2], m[2][2]), y, std::atan2(m[0][1], m[0][0])) / kRadian;
}

quat turned(const vec3& degrees) {
    const vec3 r = degrees * kRadian;
    return glm::angleAxis(r.z, kAxes[2]) * glm::angleAxis(r.y, kAxes[1]) * glm::angleAxis(r.x, kAxes[0]);
}

// Rounded to hundredths, so that values in a scene file stay readable.
vec3 rounded(const vec3& v, float step) { return glm::round(v / step) * step; }

// Where a scene has a thing; null: it has no such number. `V`: vec3, or const vec3 of a scene that is not changed.
template <class V>
struct Place {
    V *position = nullptr, *rotation = nullptr;
    bool recreate = false;
};

template <class V, class S>
Place<V> placeIn(const Manipulator::Thing& thing, S& scene) {
    using Kind = Manipulator::Thing::Kind;
    const size_t k = thing.index;
    switch (thing.kind) {
        case Kind::collider:
            if (k < scene.colliders.size()) return {&scene.colliders[k].position, &scene.colliders[k].rotation, true};
            break;
        case Kind::body:
            if (k < scene.bodies.size()) return {&scene.bodies[k].position, &scene.bodies[k].rotation, true};
            break;
        case Kind::emitter:
            if (k < scene.emitters.size()) return {&scene.emitters[k].position, nullptr, scene.emitters[k].shape == "mesh"};
            break;
        case Kind::sink:
            if (k < scene.sinks.size()) return {&scene.sinks[k].position, nullptr, false};
            break;
        case Kind::none:
            break;
    }
    return {};
}
Place<vec3> placeOf(const Manipulator::Thing& thing, SceneFile& scene) { return placeIn<vec3>(thing, scene); }
Place<const vec3> placeOf(const Manipulator::Thing& thing, const SceneFile& scene) { return placeIn<const vec3>(thing, scene); }

}  // namespace

ViewRay rayThrough(const Camera& camera, const vec2& mouse, const vec2& size) {
    const mat4 back = glm::inverse(camera.projection(size.x / size.y) * camera.view());
    const vec2 at(2 * mouse.x / size.x - 1, 1 - 2 * mouse.y / size.y);
    const vec4 far = back * vec4(at, 1.0F, 1.0F);
    return {camera.position, vec3(far) / far.w - camera.position};
}

std::optional<vec2> seenAt(const Camera& camera, const vec3& p, const vec2& size) {
    const vec4 clip = camera.projection(size.x / size.y) * camera.view() * vec4(p, 1.0F);
    if (clip.w <= 0) return std::nullopt;
    return vec2(0.5F + 0.5F * clip.x / clip.w, 0.5F - 0.5F * clip.y / clip.w) * size;
}

// The handles are at the centre of the drawn thing, moved by the change in the draft.
std::optional<Manipulator::Handles> Manipulator::handles(const Camera& camera, const Session& session, const SceneFile& draft) const {
    // A body that floats is thrown; where it was at the start is a number in the panel.
    if (chosen_.kind == Thing::Kind::body && (chosen_.index >= draft.bodies.size() || !draft.bodies[chosen_.index].fixed))
        return std::nullopt;
    const Bounds bounds = session.boundsOf(chosen_);
    if (bounds.empty()) return std::nullopt;
    const Place<const vec3> wanted = placeOf(chosen_, draft), shown = placeOf(chosen_, session.scene());
    if (wanted.position == nullptr || shown.position == nullptr) return std::nullopt;
    const vec3 centre = bounds.centre() + *wanted.position - *shown.position;
    return Handles{centre, kReach * glm::distance(camera.position, centre)};
}

Manipulator::Part Manipulator::partAt(const Handles& h, const Camera& camera, const vec2& mouse, const vec2& size, bool turns) const {
    Part nearest = Part::none;
    float most = kHandleReach;
    const auto middle = seenAt(camera, h.centre, size);
    for (int k = 0; k < 3; ++k) {
        const auto end = seenAt(camera, h.centre + h.length * kAxes[static_cast<size_t>(k)], size);
        if (middle && end && fromSegment(mouse, *middle, *end) < most) {
            most = fromSegment(mouse, *middle, *end);
            nearest = static_cast<Part>(static_cast<int>(Part::alongX) + k);
        }
        for (int c = 0; turns && c < kCorners; ++c) {
            const float step = 2 * kPi / kCorners;
            const auto a = seenAt(camera, onRing(h.centre, k, kRing * h.length, step * static_cast<float>(c)), size),
                       b = seenAt(camera, onRing(h.centre, k, kRing * h.length, step * static_cast<float>(c + 1)), size);
            if (!a || !b || fromSegment(mouse, *a, *b) >= most) continue;
            most = fromSegment(mouse, *a, *b);
            nearest = static_cast<Part>(static_cast<int>(Part::aboutX) + k);
        }
    }
    return nearest;
}

void Manipulator::grab(const ViewRay& ray, const Camera& camera, Session& session) {
    const auto met = session.meet(ray.origin, ray.direction);
    if (!met || met->thing.kind != Thing::Kind::body || session.replaying() != nullptr) return;
    const BodyParams& body = session.scene().bodies[met->thing.index];
    if (body.fixed) return;
    const BodyState& state = session.world().expectedBodies()[met->thing.index];
    const vec3 forward = glm::normalize(camera.target - camera.position);
    held_ =
        Held{{static_cast<uint32_t>(met->thing.index), glm::inverse(state.pose.rotation) * (met->place - state.pose.position), met->place},
             glm::dot(met->place - camera.position, forward)};
    chosen_ = met->thing;
}

Manipulator::Asks Manipulator::take(const InputEvents& input, const Camera& camera, Session& session, SceneFile& draft) {
    Asks asks;
    const vec2 size(glm::max(input.size, ivec2(1)));
    const ViewRay ray = rayThrough(camera, input.mouse, size);
    const bool down = input.down(MouseButton::left);
    if (input.pressed(MouseButton::left)) {
        pressedAt_ = input.mouse;
        mayChoose_ = true;
        const auto standing = handles(camera, session, draft);
        const Place<vec3> place = placeOf(chosen_, draft);
        if (standing && place.position != nullptr) {
            const Part part = partAt(*standing, camera, input.mouse, size, place.rotation != nullptr);
            const int axis = (static_cast<int>(part) - 1) % 3;
            std::optional<float> begin;
            if (part != Part::none)
                begin = part < Part::aboutX ? alongAxis(ray, standing->centre, kAxes[static_cast<size_t>(axis)])
                                            : aboutAxis(ray, standing->centre, axis);
            if (begin)
                move_ = Move{part, *place.position, place.rotation != nullptr ? *place.rotation : vec3(0.0F), standing->centre, *begin};
        }
        if (!move_) grab(ray, camera, session);
    }
    if (glm::distance(input.mouse, pressedAt_) > kStill) mayChoose_ = false;
    if (held_) {
        asks.mouse = true;
        const vec3 forward = glm::normalize(camera.target - camera.position);
        held_->hold.to = ray.at(held_->depth / std::max(glm::dot(ray.direction, forward), 1.0e-6F));
        if (!down) held_.reset();
        session.hold(held_ ? std::optional(held_->hold) : std::nullopt);
    }
    if (move_) {
        asks.mouse = true;
        const Place<vec3> place = placeOf(chosen_, draft);
        const int axis = (static_cast<int>(move_->part) - 1) % 3;
        const vec3& along = kAxes[static_cast<size_t>(axis)];
        const bool turns = move_->part >= Part::aboutX;
        const std::optional<float> now = turns ? aboutAxis(ray, move_->centre, axis) : alongAxis(ray, move_->centre, along);
        if (place.position != nullptr && now) {
            if (turns && place.rotation != nullptr)
                *place.rotation = rounded(anglesOf(glm::angleAxis(*now - move_->begin, along) * turned(move_->rotation)), 0.1F);
            if (!turns) *place.position = rounded(move_->position + along * (*now - move_->begin), 1.0e-3F);
            asks.edited = !place.recreate;
        }
        if (!down || place.position == nullptr) {
            const bool moved = place.position != nullptr &&
                               (*place.position != move_->position || (place.rotation != nullptr && *place.rotation != move_->rotation));
            if (moved) before_ = Before{chosen_, move_->position, move_->rotation, *place.position};
            asks.recreate = moved && place.recreate;
            move_.reset();
        }
    } else if (input.buttonReleased[0] && mayChoose_ && !asks.mouse) {
        const auto met = session.meet(ray.origin, ray.direction);
        chosen_ = met ? met->thing : Thing{};
    }
    return asks;
}

bool Manipulator::undo(SceneFile& draft, Asks& asks) {
    if (!before_) return false;
    const Place<vec3> place = placeOf(before_->thing, draft);
    if (place.position == nullptr || *place.position != before_->movedTo) return false;
    std::swap(*place.position, before_->position);  // once more, and it is done again
    before_->movedTo = *place.position;
    if (place.rotation != nullptr) std::swap(*place.rotation, before_->rotation);
    asks.edited = true;
    asks.recreate = place.recreate;
    return true;
}

void Manipulator::release() { held_.reset(); }

void Manipulator::draw(const InputEvents& input, const Camera& camera, const Session& session, const SceneFile& draft) const {
    const vec2 size(glm::max(input.size, ivec2(1)));
    const float scale = size.x / std::max(ImGui::GetIO().DisplaySize.x, 1.0F);  // window coordinates in one of ImGui's
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    const auto line = [&](const vec3& a, const vec3& b, ImU32 colour, float width) {
        const auto from = seenAt(camera, a, size), to = seenAt(camera, b, size);
        if (from && to) list.AddLine(ImVec2(from->x / scale, from->y / scale), ImVec2(to->x / scale, to->y / scale), colour, width);
    };
    if (held_) {
        const BodyState& state = session.world().expectedBodies()[held_->hold.body];
        line(state.pose.position + state.pose.rotation * held_->hold.at, held_->hold.to, IM_COL32(255, 255, 255, 200), 2);
        return;
    }
    if (chosen_.kind == Thing::Kind::none) return;
    Bounds bounds = session.boundsOf(chosen_);
    if (bounds.empty()) return;
    const Place<const vec3> wanted = placeOf(chosen_, draft), shown = placeOf(chosen_, session.scene());
    const vec3 off = wanted.position != nullptr && shown.position != nullptr ? *wanted.position - *shown.position : vec3(0.0F);
    // An object that is being rotated is shown as its rotated box.
    const quat turn = wanted.rotation != nullptr && shown.rotation != nullptr
                          ? turned(*wanted.rotation) * glm::inverse(turned(*shown.rotation))
                          : quat(1, 0, 0, 0);
    const vec3 pivot = shown.position != nullptr ? *shown.position : bounds.centre();
    const auto corner = [&](int k) {
        const vec3 p((k & 1) != 0 ? bounds.max.x : bounds.min.x, (k & 2) != 0 ? bounds.max.y : bounds.min.y,
                     (k & 4) != 0 ? bounds.max.z : bounds.min.z);
        return pivot + turn * (p - pivot) + off;
    };
    for (int k = 0; k < 8; ++k)
        for (const int bit : {1, 2, 4})
            if ((k & bit) == 0) line(corner(k), corner(k | bit), IM_COL32(255, 210, 90, 170), 1.5F);
    const auto h = handles(camera, session, draft);
    if (!h) return;
    constexpr std::array<ImU32, 3> kColours = {IM_COL32(235, 85, 75, 255), IM_COL32(110, 205, 95, 255), IM_COL32(85, 145, 245, 255)};
    const Part over = move_ ? move_->part : partAt(*h, camera, input.mouse, size, wanted.rotation != nullptr);
    for (int k = 0; k < 3; ++k) {
        const auto axis = static_cast<size_t>(k);
        const auto colour = [&](Part first) {
            return over == static_cast<Part>(static_cast<int>(first) + k) ? IM_COL32(255, 255, 255, 255) : kColours[axis];
        };
        const vec3 end = h->centre + h->length * kAxes[axis];
        line(h->centre, end, colour(Part::alongX), 3);
        if (const auto tip = seenAt(camera, end, size))
            list.AddCircleFilled(ImVec2(tip->x / scale, tip->y / scale), 5, colour(Part::alongX));
        for (int c = 0; wanted.rotation != nullptr && c < kCorners; ++c) {
            const float step = 2 * kPi / kCorners;
            line(onRing(h->centre, k, kRing * h->length, step * static_cast<float>(c)),
                 onRing(h->centre, k, kRing * h->length, step * static_cast<float>(c + 1)), colour(Part::aboutX), 2);
        }
    }
}

}  // namespace rivulet
