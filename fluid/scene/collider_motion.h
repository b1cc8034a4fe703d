// Where a scene's colliders are at a time.
#pragma once

#include <span>
#include <vector>

#include "fluid/scene/scene_file.h"
#include "fluid/sim/solids/solids.h"

namespace rivulet {

// Of a collider whose mesh was placed in the world and then moved by -position, so that it turns about that point. `turned`: deg it has
// spun so far (a spin may change while it runs), `time` s.
Pose colliderPose(const ColliderParams& collider, double time, double turned);

mat4 matrixOf(const Pose& pose);  // own frame -> world

// The vertices of a mesh that rests as `rest` (m, world), with the collider's wave at `time` (s).
void waveShape(const ColliderWave& wave, std::span<const vec3> rest, double time, std::vector<vec3>& shape);

// Holds the mesh at every time.
Bounds waveReach(const ColliderWave& wave, const Bounds& rest);

}  // namespace rivulet
