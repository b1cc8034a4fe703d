// Picking: the first node of a scene that a ray hits.
#pragma once

#include <optional>

#include "engine/scene/scene.h"

namespace rivulet {

struct Picked {
    size_t node = 0;     // index into Scene::nodes()
    float distance = 0;  // in units of the length of `direction`
    vec3 place{0.0F};    // the point hit; m, world
    vec3 normal{0.0F};   // unit, towards the ray's origin
};

// Tests both sides of all visible triangles in their rest pose: deformations by bones and morphs are ignored. The cost is linear in the
// number of triangles.
std::optional<Picked> pick(const Scene& scene, const vec3& origin, const vec3& direction);

// The distance at which a ray hits a triangle, in units of the length of `direction`; negative: no hit before `most`. Moeller and Trumbore
// 1997.
float meets(const vec3& origin, const vec3& direction, const vec3& a, const vec3& b, const vec3& c, float most);

}  // namespace rivulet
