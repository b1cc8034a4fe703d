// Where skin lies near other skin: lips, eyelids, the two sides of an ear. A drop on one must not be drawn on the other.
#pragma once

#include <vector>

#include "fluid/flow/flow_mesh.h"

namespace rivulet {

// Of each triangle 1 if within `reach` of it (m, at rest) there is skin that one does not come to by going along the skin near by, or that
// faces the other way.
std::vector<uint8_t> skinFolds(const FlowMesh& mesh, float reach);

}  // namespace rivulet
