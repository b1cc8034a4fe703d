// A mesh as voxels: one entry for the three ways of doing it.
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
    int resolution = 128;      // voxels along the longest side of the meshes' bounds, 2..4096
    bool thesisOrder = false;  // mode depth: the thesis's order of work boxes instead of the short one; the result is the same
    size_t memoryLimit =
        size_t{4} << 30U;  // bytes of bits, labels and what the mode needs on the way; what the triangles take is not counted
    std::function<bool(double)> progress;  // called now and then with 0..1 from the calling thread; false cancels. May be empty
};

struct VoxelModel {
    VoxelMode mode = VoxelMode::solid;
    VoxelGrid surface;   // INSIDE_SURFACE: voxels that a triangle overlaps, touching counts (depth: as its pixels see it)
    VoxelGrid bits;      // mode surface: the same; else 1 where not OUTSIDE (the thesis's storage)
    VoxelLabels labels;  // mode surface: by connectivity alone
    MeshDefects defects;
    double milliseconds =
        0;  // mesh in memory to bits (solid: surface and inside bits, cleaning included); without labels but in mode depth
};

// The grid of `resolution` voxels around the meshes' bounds, bits clear: the thesis's work box, without padding: exactly so many along the
// longest side, as many whole ones as are needed along the others, at least 1, the mesh in the middle. Every triangle is within the
// closed grid, also as floats are rounded. `memoryLimit` bounds the bits. Errors as voxelizeMesh.
Result<VoxelGrid> layoutGrid(std::span<const MeshView> meshes, int resolution, size_t memoryLimit);

// `meshes` in any unit. On every Device the same bits. Error (badInput): no triangle, an index out of range, NaN or infinite vertices
// (with how many), no extent, a resolution outside its range or beyond the memory (with how much it needs and what fits), voxels too
// small for 32-bit floats so far from the origin. Error (failed): cancelled, out of memory, a device without 64-bit floats.
Result<VoxelModel> voxelizeMesh(Device& device, std::span<const MeshView> meshes, const VoxelizeOptions& options);

// A sentence if the mesh has features that this voxel cannot show (with the resolution and memory they would need); else "".
// Features are guessed from edges: the length that 5 % of them (of a sample of a million) are shorter than. Smooth meshes have edges
// shorter than a voxel too, and nothing is lost; so it says something only where a voxel is as long as 32 of them.
std::string lostFeatures(std::span<const MeshView> meshes, const VoxelGrid& grid);

}  // namespace rivulet
