// The static field: every static mesh collider of a scene baked into surface bits and a narrow band of exact triangle distance.
#pragma once

#include <vector>

#include "engine/core/mesh_view.h"
#include "engine/core/result.h"
#include "fluid/voxel/voxel_grid.h"
#include "shaders/voxel/field_params.h"

namespace rivulet {

// Distance is sampled at grid points p = origin + voxel * (x, y, z), 0 <= x <= size.x and so on: (size + 1) points an axis, x fastest.
struct VoxelField {
    VoxelGrid surface;             // voxels that a triangle passes through, touching counts
    std::vector<float> distance;   // m, to the nearest triangle, exact within `band`, `band` beyond it; negative inside, if `closed`
    std::vector<uint32_t> normal;  // within the band: from the nearest triangle to the point, and whose it is: packNormal
    float band = 0;                // m
    bool closed = false;           // every mesh is watertight, and so has an inside; else no distance is negative
    bool empty() const { return surface.count() == 0; }
    size_t bytes() const { return surface.bits.size() + distance.size() * sizeof(float) + normal.size() * sizeof(uint32_t); }
    // A lower bound (m) of the distance from `p` to the mesh, at most sqrt(3) voxels below it and never above `band`: distance changes
    // by no more than one moves, whichever side of the mesh one is on (`p` may be inside). May be negative near the mesh. A particle may be
    // born at `p` if clearance(p) >= contact.
    float clearance(const vec3& p) const;
    // Whether the grid point nearest to `p` is inside a mesh; false where not all are closed, and outside the grid.
    bool inside(const vec3& p) const;
};

struct VoxelFieldOptions {
    int resolution = 128;                   // voxels along the longest side of the meshes' bounds, 2..2048
    float band = 0;                         // m, at least this wide (and at least kBandVoxels voxels)
    float padding = 0;                      // m, around the bounds: at least the band, so that whoever comes near is inside the grid
    size_t memoryLimit = size_t{1} << 30U;  // bytes the field may take
    // Of each mesh, 0..kMaxSurface: what wallSurface of shaders/fluid/solids/contact_walls.h says of its walls. Empty: all 0.
    std::span<const uint8_t> surfaces = {};
};

inline constexpr uint8_t kMaxSurface = 15;

// The narrowest useful band: contact at 1.74 voxels, a cell's diagonal of 1.74, and room to see walls coming.
inline constexpr float kBandVoxels = 5.0F;

// In voxels, a little over sqrt(3). Let p be a point whose voxel a triangle touches: all 8 samples around p are within sqrt(3)
// voxels of that triangle, so the interpolated distance at p is too. Who keeps 1.74 is hence in no set voxel; and all 8 samples
// around him lie on his own side of the mesh, so that the unsigned distance is as smooth there as a signed one.
inline constexpr float kContactVoxels = 1.74F;

// `meshes` in world space (m). Error: no triangle, an index out of range, NaN or infinite vertices (with how many), meshes of no
// extent or too far from the origin for floats, a resolution outside 2..2048, too much memory (with how much, and what resolution fits),
// a surface above kMaxSurface or not one a mesh.
// The same bits and distances for any number of threads. A grid point is inside if one of the meshes, made consistent by cleanMesh, winds
// round it; nearer to a mesh than the grid's origin is rounded (1/32 voxel at worst, 1e-5 as a rule) it may count for either side.
Result<VoxelField> bakeVoxelField(std::span<const MeshView> meshes, const VoxelFieldOptions& options);

// What bakeVoxelField starts from: its checks, its grid with no bit set, distances at the band. `reach`: lay the grid out over this instead
// of the meshes' bounds, which then need not fill it. `extra`: bytes a grid point that the caller will need besides.
Result<VoxelField> emptyVoxelField(std::span<const MeshView> meshes, const Bounds* reach, const VoxelFieldOptions& options, size_t extra);

// How particles meet the field.
struct FieldContact {
    float spacing = 0;        // m, rest distance of particles
    float restSpeed = 0;      // m/s, slower approaches do not bounce; 2 |gravity| dt is a good value
    uint32_t countIndex = 0;  // of the buffer whose element [countIndex] is the number of active particles
};

// The parameter block of shaders/fluid/solids/collide.kernel. The surfaces' friction and restitution follow the normals in their buffer.
FieldParams fieldParams(const VoxelField& field, const FieldContact& contact);

}  // namespace rivulet
