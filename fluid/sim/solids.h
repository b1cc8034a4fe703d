// The solids a world is made among.
#pragma once

#include <vector>

#include "engine/core/math.h"
#include "fluid/voxel/voxel_field.h"

namespace rivulet {

// Water stays on the side the normal points to.
struct PlaneSolid {
    vec3 position{0.0F};            // m, a point on it
    vec3 normal{0.0F, 1.0F, 0.0F};  // any length but 0
};

// What does not move.
struct StaticSolids {
    const VoxelField* field = nullptr;  // the meshes, baked; null or empty = none. Must outlive the world.
    std::vector<PlaneSolid> planes;
};

}  // namespace rivulet
