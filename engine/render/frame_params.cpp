#include "engine/render/frame_params.h"

#include <algorithm>

#include "engine/scene/light.h"

namespace rivulet {
namespace {

// Three softboxes. Their directions follow the key light. The two that may light matte surfaces become as bright as that light requires.
void placeSoftboxes(FrameParams& f, const Studio& studio) {
    const vec3 key(f.lightDir), colour(f.lightColour);
    const float flatLength = glm::length(vec2(key.x, key.z));
    const vec3 ahead = flatLength > 1e-3F ? vec3(key.x, 0.0F, key.z) / flatLength : vec3(1, 0, 0), side(-ahead.z, 0.0F, ahead.x);
    const vec3 tint = colour / std::max({colour.x, colour.y, colour.z, 1e-4F});
    const struct {
        vec3 towards;
        vec2 halfSize;
        vec3 radiance;
        float share = 0.0F;
    } boxes[3] = {{key, {0.30F, 0.22F}, 3.0F * colour},                                                         // around the key light
                  {side * 0.9F - ahead * 0.35F + vec3(0, 0.45F, 0), {0.14F, 0.50F}, 3.0F * tint, studio.fill},  // a strip at one side
                  {side * -0.5F - ahead * 0.9F + vec3(0, 0.55F, 0),
                   {0.70F, studio.rim > 0 ? 0.30F : 0.07F},
                   {2.6F, 2.85F, 3.0F},
                   studio.rim}};  // a wide one opposite the key
    for (size_t k = 0; k < 3; ++k) {
        const vec3 towards = glm::normalize(boxes[k].towards);
        f.boxTowards[k] = vec4(towards, boxes[k].halfSize.x);
        f.boxSide[k] = vec4(glm::normalize(glm::cross(vec3(0.0F, 1.0F, 0.001F), towards)), boxes[k].halfSize.y);
        // Of radiance 1 the light on a surface that faces the box, by what a key light of radiance 1 gives there.
        const float perRadiance = 4.0F * boxes[k].halfSize.x * boxes[k].halfSize.y;
        const float bright = std::max({colour.x, colour.y, colour.z}) * boxes[k].share / perRadiance;
        const float own = std::max({boxes[k].radiance.x, boxes[k].radiance.y, boxes[k].radiance.z, 1e-4F});
        // A faint light is no fainter in reflections, so that nothing jumps where it is switched off.
        const float times = bright / own;
        f.boxRadiance[k] = vec4(boxes[k].radiance * std::max(1.0F, times), perRadiance / kPi * std::min(1.0F, times));
    }
}

// The same with depths that grow downwards instead of along the light, which orders what a ray of light meets alike: then a floor has one
// depth, and a blurred map does not take its farther parts for light behind a point.
// `range`: m along the light, of a unit of depth.
mat4 levelDepth(mat4 projection, const Light& light, const Bounds& meshes, const Studio& studio, float& range) {
    const float down = glm::normalize(light.direction).y, top = meshes.max.y;
    if (down < 0.3F) return projection;
    const float height = top - std::min(meshes.min.y, studio.floorHeight);
    range = std::max(range, height / down);
    const float perMetre = 2.0F / (down * range);
    for (int column = 0; column < 4; ++column) projection[column][2] = 0.0F;
    projection[1][2] = -perMetre;
    projection[3][2] = perMetre * top - 1.0F;
    return projection;
}

}  // namespace

FrameParams packFrame(const FrameView& view, const Studio& studio, const Bounds& meshes, const Bounds& water) {
    FrameParams f{};
    const mat4& p = view.projection;
    const auto width = static_cast<float>(view.width), height = static_cast<float>(view.height);
    f.view = view.view;
    f.projection = p;
    f.viewProjection = p * view.view;
    f.inverseView = glm::inverse(view.view);
    const Light light{view.lightDirWorld, view.lightColour};
    if (!meshes.empty()) {
        f.shadow.x = 1.0F;
        f.shadow.z = glm::length(meshes.size());
        f.shadowProjection = light.projection(meshes);
        if (studio.showFloor) f.shadowProjection = levelDepth(f.shadowProjection, light, meshes, studio, f.shadow.z);
    }
    if (!water.empty()) {
        f.waterProjection = light.projection(water);
        f.shadow.y = 1.0F;
        f.shadow.w = glm::length(water.size());
    }
    f.cameraPos = vec4(view.cameraPosWorld, static_cast<float>(view.time));
    f.viewport = vec4(width, height, 1.0F / width, 1.0F / height);
    f.ray = vec4(2.0F / (width * p[0][0]), 2.0F / (height * p[1][1]), (p[2][0] - p[3][0] - 1.0F) / p[0][0],
                 (p[2][1] - p[3][1] - 1.0F) / p[1][1]);
    f.planes = vec4(view.nearPlane, view.farPlane, p[2][2], p[3][2]);
    f.lightDir = vec4(glm::normalize(view.lightDirWorld), 0.0F);
    f.lightColour = vec4(view.lightColour, 0.0F);
    placeSoftboxes(f, studio);
    f.horizon = vec4(studio.horizon, studio.tiles);
    f.zenith = vec4(studio.zenith, 0.0F);
    f.floorColour = vec4(studio.floor, studio.floorHeight);
    const Bounds& shown = studio.shown;
    const float radius = shown.empty() ? 1.0F : 0.5F * glm::length(shown.size());
    const vec3 centre = shown.empty() ? vec3(0.0F) : shown.centre();
    f.floorFade = vec4(centre.x, centre.z, radius, studio.showFloor ? 1.0F : 0.0F);
    return f;
}

}  // namespace rivulet
