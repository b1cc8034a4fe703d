// Voxelises meshes: one entry for the three modes.
#pragma once

#include <functional>
#include <span>
#include <string>

#include "engine/compute/device.h"
#include "engine/core/mesh_view.h"
#include "engine/core/result.h"
#include "engine/core/table.h"
#include "fluid/voxel/labels.h"
#include "fluid/voxel/mesh_defects.h"
#include "fluid/voxel/voxel_grid.h"

namespace rivulet {

enum class VoxelMode : uint32_t { depth, solid, surface };

struct VoxelModeRow {
    const char* name;  // "depth", "solid", "surface"
    const char* doc;
    VoxelMode mode;
};
Table<VoxelModeRow> voxelModes();

inline constexpr int kMinVoxelResolution = 2, kMaxVoxelResolution = 4096;

struct VoxelizeOptions {
    VoxelMode mode = VoxelMode::solid;
    int resolution = 128;                   // voxels along the longest side of the meshes' bounds, 2..4096
    bool thesisOrder = false;               // mode depth: the thesis's order of work boxes instead of the shorter one; same result
    size_t memoryLimit = size_t{4} << 30U;  // bytes of bits, labels and temporary data of the mode; triangles are not counted
    std::function<bool(double)> progress;   // called repeatedly with 0..1 from the calling thread; false cancels. May be empty
};

struct VoxelModel {
    VoxelMode mode = VoxelMode::solid;
    VoxelGrid surface;   // INSIDE_SURFACE: voxels that a triangle overlaps, touching counts (depth: as its pixels show it)
    VoxelGrid bits;      // mode surface: the same; else 1 where not OUTSIDE (the thesis's storage)
    VoxelLabels labels;  // mode surface: by connectivity alone
    MeshDefects defects;
    double milliseconds = 0;  // from the mesh in memory to bits (solid: surface and inside bits, with cleaning); labels only in mode depth
};

// The grid around the meshes' bounds, bits clear, without padding (the thesis's work box): exactly `resolution` voxels along the longest
// side, the smallest sufficient number along the others, at least 1, with the mesh in the middle. Every triangle is within the closed grid,
// also after rounding to floats. `memoryLimit` limits the bits. Errors: those of voxelizeMesh.
Result<VoxelGrid> layoutGrid(std::span<const MeshView> meshes, int resolution, size_t memoryLimit);

// `meshes` in any unit. Every Device gives the same bits. Error (badInput): no triangle, an index out of range, NaN or infinite vertices
// (with their number), no extent, a resolution outside its range or beyond the memory (with the amount and what fits), voxels too
// small for 32-bit floats at that distance from the origin. Error (failed): cancelled, out of memory, a device without 64-bit floats.
Result<VoxelModel> voxelizeMesh(Device& device, std::span<const MeshView> meshes, const VoxelizeOptions& options);

// A sentence if the mesh has features that voxels of this size cannot show (with the resolution and memory they would need); else "".
// The feature size is estimated from edges: 5 % of them (of a sample of a million) are shorter. Smooth meshes also have edges shorter than
// a voxel, and lose nothing; so a sentence is returned only if a voxel is as long as 32 such edges.
std::string lostFeatures(std::span<const MeshView> meshes, const VoxelGrid& grid);

}  // namespace rivulet
