#include "fluid/sim/sources/dry.h"

#include <fmt/format.h>

#include <algorithm>
#include <glm/gtc/quaternion.hpp>

#include "engine/core/param_check.h"
#include "engine/core/param_path.h"

namespace rivulet {

namespace {

constexpr float kLeast = 1.0e-6F;  // m

Pose poseOf(const DryParams& p) {
    const vec3 angles = glm::radians(p.rotation);
    return {p.position,
            glm::angleAxis(angles.z, vec3(0, 0, 1)) * glm::angleAxis(angles.y, vec3(0, 1, 0)) * glm::angleAxis(angles.x, vec3(1, 0, 0))};
}

DryVolume volumeOf(const DryParams& p, const Pose& pose, float frame) {
    return {vec4(pose.position, p.shape == "box" ? 0.0F : 1.0F), vec4(0.5F * p.size, frame),
            vec4(pose.rotation.x, pose.rotation.y, pose.rotation.z, pose.rotation.w)};
}

size_t bodyOf(const DryParams& p, const DryBodies& bodies) {
    return static_cast<size_t>(std::ranges::find(bodies.ids, static_cast<uint32_t>(p.body)) - bodies.ids.begin());
}

}  // namespace

void DryParams::visit(ParamVisitor& v) {
    static const std::vector<std::string> shapes = {"box", "ellipsoid"};
    v.choice({.name = "shape", .doc = "shape of the volume that stays dry"}, shape, shapes);
    v.value({"position", "m", "centre of the volume; with a body, at t = 0", -kMaxPosition, kMaxPosition}, position);
    v.value({"rotation", "deg", "rotation about x, then y, then z; with a body, at t = 0", -360, 360}, rotation);
    v.value({"size", "m", "edge lengths of a box, or axes of an ellipsoid; each above 0", 0, kMaxPosition}, size);
    v.value({"body", "", "id of the body that it moves with: of a scene's, its index; -1 = none", -1, 1.0e6}, body);
}

Status checkDry(std::span<const DryParams> volumes, std::span<const uint32_t> ids) {
    if (volumes.size() > kMostDry)
        return badInput(fmt::format("{} volumes stay dry, and {} are possible: join some", volumes.size(), kMostDry));
    for (size_t k = 0; k < volumes.size(); ++k) {
        const DryParams& d = volumes[k];
        if (Status s = checkParams(pathOf("dry", k), d); !s) return s;
        if (!glm::all(glm::greaterThan(d.size, vec3(kLeast))))
            return badInput(fmt::format("dry[{}].size is ({}, {}, {}) m: give three lengths above 0", k, d.size.x, d.size.y, d.size.z));
        if (d.body >= 0 && std::ranges::find(ids, static_cast<uint32_t>(d.body)) == ids.end())
            return badInput(
                fmt::format("dry[{}].body is {}, and no body has this id: use that of one of the {} bodies, or -1", k, d.body, ids.size()));
    }
    return ok();
}

std::vector<DryVolume> placedDry(std::span<const DryParams> volumes, const DryBodies& bodies) {
    std::vector<DryVolume> placed;
    placed.reserve(volumes.size());
    for (const DryParams& d : volumes) {
        Pose pose = poseOf(d);
        if (d.body >= 0) {
            const size_t k = bodyOf(d, bodies);
            const Pose &start = bodies.starts[k], &now = bodies.states[k].pose;
            pose = {now.toWorld(start.toOwn(pose.position)), glm::normalize(now.rotation * glm::conjugate(start.rotation) * pose.rotation)};
        }
        placed.push_back(volumeOf(d, pose, 0));
    }
    return placed;
}

std::vector<DryVolume> ownDry(std::span<const DryParams> volumes, const DryBodies& bodies) {
    std::vector<DryVolume> own;
    own.reserve(volumes.size());
    for (const DryParams& d : volumes) {
        Pose pose = poseOf(d);
        float frame = 0;
        if (d.body >= 0) {
            const size_t k = bodyOf(d, bodies);
            const Pose& start = bodies.starts[k];
            pose = {start.toOwn(pose.position), glm::normalize(glm::conjugate(start.rotation) * pose.rotation)};
            frame = static_cast<float>(k + 1);
        }
        own.push_back(volumeOf(d, pose, frame));
    }
    return own;
}

std::vector<DryVolume> placedDry(std::span<const DryVolume> own, std::span<const BodyState> states) {
    std::vector<DryVolume> placed(own.begin(), own.end());
    for (DryVolume& v : placed) {
        const auto body = static_cast<size_t>(v.reach.w);
        if (body == 0 || body > states.size()) continue;
        const Pose& now = states[body - 1].pose;
        const quat turn = glm::normalize(now.rotation * quat(v.turn.w, v.turn.x, v.turn.y, v.turn.z));
        v.centre = vec4(now.toWorld(vec3(v.centre)), v.centre.w);
        v.reach.w = 0;
        v.turn = vec4(turn.x, turn.y, turn.z, turn.w);
    }
    return placed;
}

bool hasMoved(const DryVolume& from, const DryVolume& to, float way) {
    const float turned = std::min(glm::length(to.turn - from.turn), glm::length(to.turn + from.turn));  // about half of the angle
    return from.centre.w != to.centre.w || from.reach != to.reach ||
           glm::distance(vec3(from.centre), vec3(to.centre)) + 2 * turned * glm::length(vec3(from.reach)) > way;
}

Bounds boundsOf(const DryVolume& volume) {
    const vec3 around(glm::length(vec3(volume.reach)));
    return {vec3(volume.centre) - around, vec3(volume.centre) + around};
}

bool isDry(std::span<const DryVolume> volumes, const vec3& place) {
    return std::ranges::any_of(volumes, [&](const DryVolume& v) {
        const Pose pose{vec3(v.centre), quat(v.turn.w, v.turn.x, v.turn.y, v.turn.z)};
        const vec3 own = pose.toOwn(place) / vec3(v.reach), squares = own * own;
        return (v.centre.w == 0.0F ? std::max({squares.x, squares.y, squares.z}) : squares.x + squares.y + squares.z) <= 1.0F;
    });
}

}  // namespace rivulet
