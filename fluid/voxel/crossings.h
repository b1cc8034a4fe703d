// Crossings of triangles with the columns of a voxel grid, and the bits that follow from them: on the host, and by kernels of a device.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "engine/compute/device.h"
#include "engine/core/result.h"
#include "fluid/voxel/voxel_grid.h"

namespace rivulet {

using Corners = std::array<dvec3, 3>;  // of a triangle, in voxels from the grid's low corner

// An indexed mesh, followed by loose triangles. Refers to the caller's memory.
struct CrossedTriangles {
    std::span<const dvec3> places;
    std::span<const uint32_t> indices;  // 3 a triangle, into places
    std::span<const Corners> loose;
    size_t size() const { return indices.size() / 3 + loose.size(); }
    Corners operator[](size_t k) const {
        if (3 * k >= indices.size()) return loose[k - indices.size() / 3];
        return {places[indices[3 * k]], places[indices[3 * k + 1]], places[indices[3 * k + 2]]};
    }
};

// The crossings of each column of voxels along x. Columns are (y, z), y fastest.
struct ColumnCrossings {
    std::vector<uint32_t> start;  // into items; one more than columns
    std::vector<uint32_t> items;  // voxel << 1 | (1 if the winding number's change is +1, 0 if -1), sorted within a column
    std::span<const uint32_t> column(size_t k) const { return std::span(items).subspan(start[k], start[k + 1] - start[k]); }
};
// The first voxel whose centre lies beyond the crossing, and the change of the winding number there.
inline int crossedVoxel(uint32_t crossing) { return static_cast<int>(crossing >> 1U); }
inline int crossedChange(uint32_t crossing) { return (crossing & 1U) != 0 ? 1 : -1; }

// Sets the bits of `grid` (clear before) where the sum of the crossings is not 0. Throws std::bad_alloc.
ColumnCrossings crossColumns(const CrossedTriangles& triangles, VoxelGrid& grid);

// The same by kernels of a gl or cl device, for grids of fewer than 2^32 voxels. Downloads the crossings only if `wanted`.
Result<ColumnCrossings> crossColumnsOn(Device& device, const CrossedTriangles& triangles, VoxelGrid& grid, bool wanted);

}  // namespace rivulet
