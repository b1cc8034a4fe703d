// Open meshes: caps that close their boundary loops, so that crossings count to integers, and the caps' own part of the generalized
// winding number (Jacobson et al. 2013), to be taken off again.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "fluid/voxel/crossings.h"
#include "fluid/voxel/mesh_defects.h"
#include "fluid/voxel/voxel_grid.h"

namespace rivulet {

// Fans of triangles over the loops that a mesh's unmatched edges form. Mesh and caps together close.
class BoundaryCaps {
  public:
    // `places`: the mesh's positions in voxels from the grid's low corner.
    BoundaryCaps(const CleanMesh& mesh, std::span<const dvec3> places);
    // Caps to be crossed; of the mesh, `crossed` if there are any, else all. Where loose triangles are many, each is its own cap the other
    // way round: neither is crossed, as the two cancel.
    std::span<const Corners> triangles() const { return std::span(triangles_).first(triangles_.size() - loose_); }
    const std::vector<uint32_t>* crossed() const { return loose_ > 0 ? &crossed_ : nullptr; }
    // The caps' part of the winding number at `p` (van Oosterom and Strackee 1983).
    double winding(const dvec3& p) const;

    // `grid` has the bit of each voxel where the crossings of mesh and caps count to other than 0. Afterwards: where they count to more
    // than 1/2 off the caps' part. The same for any number of threads. With many pieces (kFew and more) it asks goOn(share done) now and
    // then, on the calling thread; false ends it, and the result is false. Beyond WindingTree::kExact pieces to that class's accuracy, else
    // exact.
    bool correct(const CleanMesh& mesh, const ColumnCrossings& crossings, VoxelGrid& grid,
                 const std::function<bool(double)>& goOn = {}) const;

  private:
    // Some consecutive triangles of one fan.
    struct Piece {
        uint32_t first = 0, end = 0;      // triangles
        uint32_t previous = 0, next = 0;  // pieces of the same fan, in a ring
        dvec3 centre{0.0};                // of a ball that holds them
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
