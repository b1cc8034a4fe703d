// Open meshes: caps that close their boundary loops, so that crossings sum to integers, and the caps' own part of the generalized
// winding number (Jacobson et al. 2013), which is subtracted again.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "fluid/voxel/crossings.h"
#include "fluid/voxel/mesh_defects.h"
#include "fluid/voxel/voxel_grid.h"

namespace rivulet {

// Fans of triangles over the loops of a mesh's unmatched edges. Mesh and caps together are closed.
class BoundaryCaps {
  public:
    // `places`: the mesh's positions in voxels from the grid's low corner.
    BoundaryCaps(const CleanMesh& mesh, std::span<const dvec3> places);
    // Caps whose crossings count. Of the mesh, the triangles of crossed() count, or all if it is null. If there are many loose triangles,
    // each has its own reverse as cap: neither is counted, because the two cancel.
    std::span<const Corners> triangles() const { return std::span(triangles_).first(triangles_.size() - loose_); }
    const std::vector<uint32_t>* crossed() const { return loose_ > 0 ? &crossed_ : nullptr; }
    // The caps' part of the winding number at `p` (van Oosterom and Strackee 1983).
    double winding(const dvec3& p) const;

    // On entry `grid` has the bits of voxels where the crossings of mesh and caps do not sum to 0; on return, where the sum differs by more
    // than 1/2 from the caps' part. The result does not depend on the number of threads. With kFew pieces or more, goOn(share done) is
    // called repeatedly on the calling thread; if it returns false, the work ends and the result is false. Exact up to WindingTree::kExact
    // pieces; above, to the accuracy of that class.
    bool correct(const CleanMesh& mesh, const ColumnCrossings& crossings, VoxelGrid& grid,
                 const std::function<bool(double)>& goOn = {}) const;

  private:
    // Consecutive triangles of one fan.
    struct Piece {
        uint32_t first = 0, end = 0;      // triangles
        uint32_t previous = 0, next = 0;  // pieces of the same fan, in a ring
        dvec3 centre{0.0};                // of a ball that contains them
        double radius = 0, area = 0, outline = 0;
    };
    struct Cell;
    class Descent;
    double winding(const Piece& piece, const dvec3& p) const;
    void addFan(std::span<const uint32_t> loop, std::span<const dvec3> places);
    void addLoose(const CleanMesh& mesh, std::span<const dvec3> places, std::span<const uint32_t> faces);

    static constexpr size_t kFew = 256;
    std::vector<Corners> triangles_;  // [0] to [1] runs along the boundary, against the mesh; [2] is the fan's tip
    std::vector<Piece> pieces_;
    std::vector<uint32_t> crossed_;  // 3 a triangle of the mesh, without the loose ones
    size_t loose_ = 0;               // triangles at the end of triangles_, each a piece, with corners in any order
};

}  // namespace rivulet
