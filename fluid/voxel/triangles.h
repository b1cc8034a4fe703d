// The triangles of several meshes as one list, in the coordinates of a voxel grid: low corner 0, voxel edge 1, in double.
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "engine/core/mesh_view.h"
#include "fluid/voxel/voxel_grid.h"

namespace rivulet {

// Corner a, and the vectors to the other corners. The vectors are differences of the mesh's own floats, so a needle keeps its shape.
struct GridTriangle {
    dvec3 a{0.0}, ab{0.0}, ac{0.0};
    dvec3 low() const { return a + glm::min(dvec3(0.0), glm::min(ab, ac)); }
    dvec3 high() const { return a + glm::max(dvec3(0.0), glm::max(ab, ac)); }
};

// Reads the meshes in place; must not outlive them. Indices are in range.
class GridTriangles {
  public:
    GridTriangles(std::span<const MeshView> meshes, const VoxelGrid& grid) : meshes_(meshes), origin_(grid.origin), voxel_(grid.voxel) {
        for (const MeshView& mesh : meshes_) ends_.push_back(size() + mesh.triangleCount());
    }
    size_t size() const { return ends_.empty() ? 0 : ends_.back(); }
    // The mesh of triangle k.
    size_t owner(size_t k) const { return static_cast<size_t>(std::upper_bound(ends_.begin(), ends_.end(), k) - ends_.begin()); }
    GridTriangle operator[](size_t k) const {
        const auto [a, b, c] = corners(k);
        return {inVoxels(a), (b - a) / voxel_, (c - a) / voxel_};
    }
    // Corners of triangle k in the mesh's own coordinates; inVoxels converts one to the grid's.
    std::array<dvec3, 3> corners(size_t k) const {
        const size_t mine = owner(k);
        const MeshView& mesh = meshes_[mine];
        const size_t first = 3 * (k - (mine == 0 ? 0 : ends_[mine - 1]));
        return {dvec3(mesh.positions[mesh.indices[first]]), dvec3(mesh.positions[mesh.indices[first + 1]]),
                dvec3(mesh.positions[mesh.indices[first + 2]])};
    }
    dvec3 inVoxels(const dvec3& p) const { return (p - origin_) / voxel_; }
    double voxel() const { return voxel_; }

  private:
    std::span<const MeshView> meshes_;
    std::vector<size_t> ends_;  // of each mesh's triangles in the list
    dvec3 origin_;
    double voxel_;
};

}  // namespace rivulet
