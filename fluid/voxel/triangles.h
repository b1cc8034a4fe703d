// The triangles of several meshes as one list, in the coordinates of a voxel grid: low corner 0, voxel edge 1, in double.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "engine/core/mesh_view.h"
#include "fluid/voxel/voxel_grid.h"

namespace rivulet {

// Corner a, and the way from it to the others. The ways are differences of the mesh's own floats, so a needle stays the needle it is.
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
    // Which mesh triangle k is of.
    size_t owner(size_t k) const { return static_cast<size_t>(std::upper_bound(ends_.begin(), ends_.end(), k) - ends_.begin()); }
    GridTriangle operator[](size_t k) const { return ofMesh(owner(k), k); }

  private:
    GridTriangle ofMesh(size_t owner, size_t k) const {
        const MeshView& mesh = meshes_[owner];
        const size_t first = 3 * (k - (owner == 0 ? 0 : ends_[owner - 1]));
        const dvec3 a(mesh.positions[mesh.indices[first]]);
        const dvec3 b(mesh.positions[mesh.indices[first + 1]]);
        const dvec3 c(mesh.positions[mesh.indices[first + 2]]);
        return {(a - origin_) / voxel_, (b - a) / voxel_, (c - a) / voxel_};
    }

    std::span<const MeshView> meshes_;
    std::vector<size_t> ends_;  // of each mesh's triangles in the list
    dvec3 origin_;
    double voxel_;
};

}  // namespace rivulet
