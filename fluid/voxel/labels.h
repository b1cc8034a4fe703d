// Connected regions of the voxels that are not surface, stored as runs along x. Each voxel is outside, surface, or of one material.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "fluid/voxel/voxel_grid.h"

namespace rivulet {

// Labels of a voxel. MATERIAL_i of the thesis is kFirstMaterial + i.
inline constexpr uint32_t kOutside = 0, kInsideSurface = 1, kFirstMaterial = 2;

// A connected region (through faces of voxels) that does not reach the grid's border, or that the mesh encloses.
struct VoxelMaterial {
    size_t voxels = 0;  // without surface voxels
    double volume = 0;  // m^3, of these voxels
    ivec3 low{0};       // the first voxel on each axis
    ivec3 high{0};      // the last
    bool solid = true;  // false: a cavity, enclosed but outside the mesh by its winding number (mode solid only)
};

// A linear colour for material `index` (0, 1, ...): equal lightness, hues of successive indices far apart; the same at every call.
vec3 materialColour(uint32_t index);

// Voxels [x, next run's x) of a row. A row's first run starts at 0; neighbours differ in label.
struct LabelRun {
    uint32_t x = 0;
    uint32_t label = kOutside;
};

// One label per voxel, stored as runs: 512^3 voxels of a bunny take 8 MB. Rows are (y, z), y fastest.
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

inline size_t rowsOf(const ivec3& size) { return static_cast<size_t>(size.y) * static_cast<size_t>(size.z); }

// Labels the connected regions of voxels that are not `surface`. `inside` (mode solid): the voxels within the mesh by winding number, of
// the same size; its bits at surface voxels are ignored; no region contains both kinds. null: connectivity alone (the thesis's rule), and
// every enclosed region counts as solid. A region is kOutside if it touches the grid's border and is not inside. The result does not depend
// on the number of threads. Throws std::bad_alloc, also for 2^32 runs or more (over 48 GB).
VoxelLabels labelRegions(const VoxelGrid& surface, const VoxelGrid* inside);

// The thesis's storage [4.1.4]: 0 where kOutside, 1 elsewhere. Origin and voxel are those of `like`.
VoxelGrid solidBits(const VoxelLabels& labels, const VoxelGrid& like);

// One byte per voxel, in the grid's order: 1 if the voxel is not set and is connected to the grid's border through faces of voxels that are
// not set; 0 for the surface and for voxels that it encloses.
std::vector<uint8_t> reachableFromBorder(const VoxelGrid& surface);

// Makes labels from known regions. `region`: one per voxel, in the grid's order: 0 is kOutside, else any number below `regions`, one for
// each material; ignored at surface voxels. No two regions may touch.
VoxelLabels labelsOf(const VoxelGrid& surface, std::span<const uint32_t> region, uint32_t regions);

}  // namespace rivulet
