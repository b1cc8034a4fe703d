// The static field: every static mesh collider of a scene baked into surface bits and a narrow band of exact triangle distance.
#pragma once

#include <vector>

#include "engine/core/mesh_view.h"
#include "engine/core/result.h"
#include "fluid/voxel/voxel_grid.h"
#include "shaders/voxel/field_params.h"

namespace rivulet {

// Distance is sampled at grid points p = origin + voxel * (x, y, z), 0 <= x <= size.x and so on: (size + 1) points per axis, x fastest.
struct VoxelField {
    VoxelGrid surface;             // voxels that a triangle overlaps, touching counts
    std::vector<float> distance;   // m, to the nearest triangle, exact within `band`, else `band`; negative inside if `closed`
    std::vector<uint32_t> normal;  // within the band: direction from the nearest triangle, and its surface number: packNormal
    float band = 0;                // m
    bool closed = false;           // every mesh is watertight and so has an inside; else no distance is negative
    bool empty() const { return surface.count() == 0; }
    size_t bytes() const { return surface.bits.size() + distance.size() * sizeof(float) + normal.size() * sizeof(uint32_t); }
    // The distance (m) from `p` to the mesh, at most `band`; `p` may be inside. Exact beside plane walls and in corners between them, to
    // second order in voxels beside curved walls, within sqrt(3) voxels everywhere. In a voxel that a triangle overlaps it is a lower
    // bound, less than kContactVoxels voxels and possibly negative.
    // A particle may be spawned at `p` if clearance(p) >= contact.
    float clearance(const vec3& p) const;
    // True if the grid point nearest to `p` is inside a mesh; false if not all meshes are closed, or outside the grid.
    bool inside(const vec3& p) const;
};

struct VoxelFieldOptions {
    int resolution = 128;                   // voxels along the longest side of the meshes' bounds, 2..2048
    float band = 0;                         // m, at least this wide (and at least kBandVoxels voxels)
    float padding = 0;                      // m, around the bounds: at least the band, so that points near the mesh are inside the grid
    size_t memoryLimit = size_t{1} << 30U;  // bytes the field may take
    // One per mesh, 0..kMaxSurface: the number that wallSurface of shaders/fluid/solids/contact_walls.h returns. Empty: all 0.
    std::span<const uint8_t> surfaces = {};
};

inline constexpr uint8_t kMaxSurface = 15;

// The narrowest useful band: contact at 1.74 voxels, the diagonal of a cell of 1.74, and a margin to detect approaching walls.
inline constexpr float kBandVoxels = 5.0F;

// In voxels, slightly above sqrt(3). Let p be a point whose voxel a triangle touches: all 8 samples around p are within sqrt(3)
// voxels of that triangle, so the interpolated distance at p is too. A particle at distance 1.74 is therefore in no set voxel, and all 8
// samples around it lie on its own side of the mesh, so the unsigned distance is as smooth there as a signed one.
inline constexpr float kContactVoxels = 1.74F;

// `meshes` in world space (m). Error: no triangle, an index out of range, NaN or infinite vertices (with how many), meshes without
// extent or too far from the origin for floats, a resolution outside 2..2048, too much memory (with the amount, and a resolution that
// fits), a surface above kMaxSurface, or not one surface per mesh. Bits and distances do not depend on the number of threads. A grid point
// is inside if one of the meshes, made consistent by cleanMesh, has a winding number other than 0 there. Nearer to a mesh than the rounding
// of the grid's origin (at most 1/32 voxel, usually 1e-5) it may count for either side.
Result<VoxelField> bakeVoxelField(std::span<const MeshView> meshes, const VoxelFieldOptions& options);

// The first step of bakeVoxelField: its checks, its grid with no bit set, distances equal to the band. `reach`: the grid covers this box
// instead of the meshes' bounds. `extra`: further bytes per grid point that the caller will need.
Result<VoxelField> emptyVoxelField(std::span<const MeshView> meshes, const Bounds* reach, const VoxelFieldOptions& options, size_t extra);

// Contact of particles with the field.
struct FieldContact {
    float spacing = 0;        // m, rest distance of particles
    float restSpeed = 0;      // m/s, slower approaches do not bounce; recommended: 2 |gravity| dt
    uint32_t countIndex = 0;  // of the buffer whose element [countIndex] is the number of active particles
};

// The parameters of shaders/fluid/solids/collide.kernel. Friction and restitution of the surfaces follow the normals in their buffer.
FieldParams fieldParams(const VoxelField& field, const FieldContact& contact);

}  // namespace rivulet
