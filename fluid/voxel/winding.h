// Open meshes: caps that close their boundary loops, so that crossings count to integers, and the caps' own part of the generalized
// winding number (Jacobson et al. 2013), to be taken off again.
#pragma once

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
    const std::vector<Corners>& triangles() const { return triangles_; }
    // The caps' part of the winding number at `p` (van Oosterom and Strackee 1983).
    double winding(const dvec3& p) const;

    // `grid` has the bit of each voxel where the crossings of mesh and caps count to other than 0. Afterwards: where they count to more
    // than 1/2 off the caps' part. The same for any number of threads.
    void correct(const CleanMesh& mesh, const ColumnCrossings& crossings, VoxelGrid& grid) const;

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

    std::vector<Corners> triangles_;  // [0] to [1] runs along the boundary, against the mesh; [2] is the fan's tip
    std::vector<Piece> pieces_;
};

}  // namespace rivulet
