// The solids of a world: walls that stand still, rigid solids that move, meshes that change their shape, floating bodies.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "engine/core/math.h"
#include "fluid/sim/solids/bodies.h"
#include "fluid/sim/solids/probes.h"
#include "fluid/sim/world/pose.h"
#include "fluid/voxel/deforming_field.h"
#include "fluid/voxel/voxel_field.h"

namespace rivulet {

// How a wall responds to a particle. Fields name surfaces by number: VoxelFieldOptions::surfaces.
struct Surface {
    float friction = -1;     // Coulomb coefficient, >= 0; negative: as fluid.collision says
    float restitution = -1;  // 0..1; negative: as fluid.collision says
};
inline constexpr size_t kMostSurfaces = 16;

// Water stays on the side the normal points to.
struct PlaneSolid {
    vec3 position{0.0F};            // m, a point on it
    vec3 normal{0.0F, 1.0F, 0.0F};  // any length but 0
    uint32_t surface = 0;
};

// Moves as a whole. Its voxels were baked in its own frame and stay there; the frame's origin is what it turns about.
struct RigidSolid {
    const VoxelField* field = nullptr;  // m; must outlive the world
    Pose pose;                          // at t = 0
};

struct Solids {
    const VoxelField* field = nullptr;  // the meshes that stand still, baked as one; null or empty = none. Must outlive the world
    std::vector<PlaneSolid> planes = {};
    std::vector<RigidSolid> rigid = {};
    std::vector<DeformingField*> deforming = {};  // in the world's frame; the world updates them. Must outlive it
    std::vector<Surface> surfaces = {};           // kMostSurfaces at most; those left out are as fluid.collision says
    std::vector<Body> bodies = {};                // floating, or made of boundary particles and standing still
    BodyHost bodyHost = {};                       // moves them; empty: they move freely
    std::vector<SolidRef> colliders = {};         // of the host's own list, for fluid.probes that name one by number
};

// What follows a field's normals in their buffer: friction and restitution of every surface, as float bits.
std::array<uint32_t, 2 * kMostSurfaces> surfaceWords(std::span<const Surface> surfaces, const Surface& otherwise);

}  // namespace rivulet
