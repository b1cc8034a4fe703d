// What of a scene a ray meets first.
#pragma once

#include <optional>

#include "engine/scene/scene.h"

namespace rivulet {

struct Picked {
    size_t node = 0;     // of Scene::nodes()
    float distance = 0;  // in lengths of `direction`
    vec3 place{0.0F};    // m, world
    vec3 normal{0.0F};   // unit, towards the ray's origin
};

// Meets visible triangles from both sides, as their meshes have them: what bones bend is met where it is at rest. A sum over all triangles.
std::optional<Picked> pick(const Scene& scene, const vec3& origin, const vec3& direction);

// Where a ray meets a triangle, in lengths of `direction`; negative: nowhere before `most`. Moeller and Trumbore 1997.
float meets(const vec3& origin, const vec3& direction, const vec3& a, const vec3& b, const vec3& c, float most);

}  // namespace rivulet
