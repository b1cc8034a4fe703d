// The place and the shape of a scene's colliders at a time.
#pragma once

#include <span>
#include <vector>

#include "fluid/scene/scene_file.h"
#include "fluid/sim/solids/solids.h"

namespace rivulet {

// Of a collider whose mesh was placed in the world and then moved by -position: it turns about that point. `turned`: deg of spin so far
// (the spin rate may change during a run); `time`: s.
Pose colliderPose(const ColliderParams& collider, double time, double turned);

mat4 matrixOf(const Pose& pose);  // own frame -> world

// The vertices of a mesh with the rest shape `rest` (m, world), displaced by the wave at `time` (s).
void waveShape(const ColliderWave& wave, std::span<const vec3> rest, double time, std::vector<vec3>& shape);

// Bounds of the mesh at all times.
Bounds waveReach(const ColliderWave& wave, const Bounds& rest);

}  // namespace rivulet
