// What the columns of a voxel grid cross, and the bits that follow: the host's own way, and the same by a device's kernels.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "engine/compute/device.h"
#include "engine/core/result.h"
#include "fluid/voxel/voxel_grid.h"

namespace rivulet {

using Corners = std::array<dvec3, 3>;  // of a triangle, in voxels from the grid's low corner

// What each column of voxels along x crosses. Columns are (y, z), y fastest.
struct ColumnCrossings {
    std::vector<uint32_t> start;  // into items; one more than columns
    std::vector<uint32_t> items;  // voxel << 1 | (1 if the winding number's change is +1, 0 if -1), sorted within a column
    std::span<const uint32_t> column(size_t k) const { return std::span(items).subspan(start[k], start[k + 1] - start[k]); }
};
// The first voxel whose centre lies beyond, and the winding number's change there.
inline int crossedVoxel(uint32_t crossing) { return static_cast<int>(crossing >> 1U); }
inline int crossedChange(uint32_t crossing) { return (crossing & 1U) != 0 ? 1 : -1; }

// Sets the bits of `grid` (clear before) where the crossings of the triangles count to other than 0. Throws std::bad_alloc.
ColumnCrossings crossColumns(std::span<const Corners> triangles, VoxelGrid& grid);

// The same by the kernels of a gl or cl device, for grids of fewer than 2^32 voxels. Fetches the crossings only if `wanted`.
Result<ColumnCrossings> crossColumnsOn(Device& device, std::span<const Corners> triangles, VoxelGrid& grid, bool wanted);

}  // namespace rivulet
