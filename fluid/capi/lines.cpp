// rivulet.h: the parts of a world as lines.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "fluid/capi/call.h"
#include "fluid/capi/convert.h"

using namespace rivulet;
using namespace rivulet::capi;

namespace {

struct Lines {
    struct Line {
        rivulet_part part;
        size_t index;
        std::array<float, 3> from, to;
    };
    std::vector<Line> all;
    rivulet_part part = RIVULET_PART_BOX;
    size_t index = 0;

    void begin(rivulet_part of, size_t at) {
        part = of;
        index = at;
    }
    void line(const vec3& from, const vec3& to) {
        Line& added = all.emplace_back(Line{part, index, {}, {}});
        put(from, added.from.data());
        put(to, added.to.data());
    }
    void box(const vec3& low, const vec3& high) {
        const auto corner = [&](int k) {
            return vec3((k & 1) != 0 ? high.x : low.x, (k & 2) != 0 ? high.y : low.y, (k & 4) != 0 ? high.z : low.z);
        };
        for (int k = 0; k < 8; ++k)
            for (const int axis : {1, 2, 4})
                if ((k & axis) == 0) line(corner(k), corner(k | axis));
    }
    void circle(const vec3& centre, const vec3& normal, float radius) {
        const vec3 n = glm::normalize(normal), a = glm::normalize(glm::cross(n, std::abs(n.y) < 0.9F ? vec3(0, 1, 0) : vec3(1, 0, 0)));
        const vec3 b = glm::cross(n, a);
        constexpr int kParts = 24;
        const auto at = [&](int k) {
            const float angle = 2 * std::numbers::pi_v<float> * static_cast<float>(k % kParts) / kParts;
            return centre + radius * (std::cos(angle) * a + std::sin(angle) * b);
        };
        for (int k = 0; k < kParts; ++k) line(at(k), at(k + 1));
    }
    void axes(const Pose& pose, float length) {
        for (int axis = 0; axis < 3; ++axis) {
            vec3 tip(0.0F);
            tip[axis] = length;
            line(pose.position, pose.position + pose.rotation * tip);
        }
    }
};

void addEmitter(Lines& lines, const EmitterParams& e) {
    constexpr float kTime = 0.1F, kLitre = 1.0e-3F;  // s; m^3
    const vec3 way = glm::normalize(e.direction);
    float speed = e.speed;
    if (e.shape == "box") {
        lines.box(e.position - 0.5F * e.size, e.position + 0.5F * e.size);
    } else {
        lines.circle(e.position, way, e.radius);
        if (speed == 0) speed = e.litresPerSecond * kLitre / (std::numbers::pi_v<float> * e.radius * e.radius);
    }
    if (speed > 0) lines.line(e.position, e.position + kTime * speed * way);
}

void addSink(Lines& lines, const SinkParams& s) {
    if (s.shape == "box") return lines.box(s.position - 0.5F * s.size, s.position + 0.5F * s.size);
    for (const vec3& axis : {vec3(1, 0, 0), vec3(0, 1, 0), vec3(0, 0, 1)}) lines.circle(s.position, axis, s.radius);
}

}  // namespace

rivulet_status rivulet_world_lines(const rivulet_world* world,
                                   void (*line)(void* user, int32_t part, size_t index, const float* from, const float* to), void* user,
                                   rivulet_error* why) {
    return with(world, why, Needs::device, [&]() -> Status {
        if (line == nullptr) return badInput("line is NULL: it receives the lines");
        const FluidWorld& of = *world->world;
        const FluidParams& fluid = of.params();
        const auto lines = std::make_shared<Lines>();
        lines->box(fluid.box.min, fluid.box.max);
        for (size_t k = 0; k < world->params.emitters.size(); ++k) {
            lines->begin(RIVULET_PART_EMITTER, k);
            addEmitter(*lines, world->params.emitters[k]);
        }
        for (size_t k = 0; k < world->params.sinks.size(); ++k) {
            lines->begin(RIVULET_PART_SINK, k);
            addSink(*lines, world->params.sinks[k]);
        }
        for (size_t k = 0; k < fluid.probes.size(); ++k) {
            lines->begin(RIVULET_PART_PROBE, k);
            lines->box(glm::clamp(fluid.probes[k].min, fluid.box.min, fluid.box.max),
                       glm::clamp(fluid.probes[k].max, fluid.box.min, fluid.box.max));
        }
        for (const auto& [k, pose] : world->walls.placesOfMoving(of)) {
            lines->begin(RIVULET_PART_WALL, k);
            lines->axes(pose, 4 * fluid.spacing);
        }
        const std::vector<BodyState>& bodies = of.expectedBodies();
        for (size_t k = 0; k < bodies.size(); ++k) {
            lines->begin(RIVULET_PART_BODY, of.bodyIds()[k]);
            lines->axes(bodies[k].pose, 4 * fluid.spacing);
        }
        world->context->hostLog.later([lines, line, user] {
            for (const Lines::Line& l : lines->all) line(user, l.part, l.index, l.from.data(), l.to.data());
        });
        return ok();
    });
}
