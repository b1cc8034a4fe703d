// The sphere that fits points best: eyeballs.
#pragma once

#include <vector>

#include "engine/core/math.h"

namespace rivulet {

// Least squares, without the points that are more than 3 % of the radius off it, such as an iris's bowl. False if the points lie in a plane
// or are fewer than 4; `centre` and `radius` (the unit of the points) are then not changed.
bool fitBall(const std::vector<vec3>& points, vec3& centre, float& radius);

}  // namespace rivulet
