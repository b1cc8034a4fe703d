// Connected regions of what is not surface, as runs along x: which voxel is outside, which is surface, which belongs to which material.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "fluid/voxel/voxel_grid.h"

namespace rivulet {

// What a voxel is. MATERIAL_i of the thesis is kFirstMaterial + i.
inline constexpr uint32_t kOutside = 0, kInsideSurface = 1, kFirstMaterial = 2;

// A connected region (through faces of voxels) that does not reach the grid's border, or that the mesh encloses.
struct VoxelMaterial {
    size_t voxels = 0;  // without surface voxels
    double volume = 0;  // m^3, of those
    ivec3 low{0};       // the first voxel on each axis
    ivec3 high{0};      // the last
    bool solid = true;  // false: a cavity, enclosed but outside the mesh by its winding number (mode solid alone tells)
};

// A linear colour for material `index` (0, 1, ...): of even lightness, neighbours in the list easy to tell apart; the same at every call.
vec3 materialColour(uint32_t index);

// Voxels [x, next run's x) of a row. A row's first run starts at 0; neighbours differ in label.
struct LabelRun {
    uint32_t x = 0;
    uint32_t label = kOutside;
};

// One label a voxel, kept as runs: 512^3 voxels of a bunny are 8 MB. Rows are (y, z), y fastest.
struct VoxelLabels {
    ivec3 size{0};
    std::vector<uint32_t> rowStart;  // into runs; size.y * size.z + 1
    std::vector<LabelRun> runs;
    std::vector<VoxelMaterial> materials;  // [label - kFirstMaterial], in order of their first voxel
    size_t outside = 0, surface = 0;       // voxels

    uint32_t at(const ivec3& c) const;  // kOutside beyond the grid
    std::span<const LabelRun> row(int y, int z) const;
    size_t bytes() const {
        return rowStart.size() * sizeof(uint32_t) + runs.size() * sizeof(LabelRun) + materials.size() * sizeof(VoxelMaterial);
    }
};

// Regions of voxels that are neither `surface` nor separated by it. Mode solid hands in `inside`, the voxels within the mesh by winding
// number (of the same size; what is surface there does not matter): no region spans both kinds. null: connectivity alone (the
// thesis's rule), and every enclosed region counts as solid. A region is kOutside if it touches the grid's border and is not inside.
// The same for any number of threads. Throws std::bad_alloc, also if there were 2^32 runs or more (over 48 GB of them).
VoxelLabels labelRegions(const VoxelGrid& surface, const VoxelGrid* inside);

// The thesis's storage [4.1.4]: 0 where kOutside, 1 elsewhere. Origin and voxel as `like`'s.
VoxelGrid solidBits(const VoxelLabels& labels, const VoxelGrid& like);

// One byte a voxel, in the grid's order: 1 where the voxel is not set and can be reached from the grid's border through faces of voxels
// that are not set; 0 for the surface and for what it encloses.
std::vector<uint8_t> reachableFromBorder(const VoxelGrid& surface);

// Labels of regions that were found in another way. `region` of each voxel, in the grid's order: 0 is kOutside, else any number below
// `regions`, one for each material; where a voxel is surface it does not matter. No two regions touch.
VoxelLabels labelsOf(const VoxelGrid& surface, std::span<const uint32_t> region, uint32_t regions);

}  // namespace rivulet
