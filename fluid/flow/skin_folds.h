// Where skin lies near other skin: lips, eyelids, the two sides of an ear. A drop on one must not be drawn on the other.
#pragma once

#include <vector>

#include "fluid/flow/flow_mesh.h"

namespace rivulet {

// Each triangle's distance (m, at rest) to skin that is not connected to it nearby, or that faces the other way; kNoFold if there is none
// within `reach`.
constexpr float kNoFold = 1.0e30F;
std::vector<float> skinFolds(const FlowMesh& mesh, float reach);

}  // namespace rivulet
