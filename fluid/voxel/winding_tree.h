// The part of very many caps in the winding number: a tree over them, its nodes as dipoles with two further moments (Barill et al. 2018),
// and cubes of voxels that share one second-order model of all that is far.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "fluid/voxel/crossings.h"
#include "fluid/voxel/voxel_grid.h"

namespace rivulet {

using dmat3 = glm::dmat3;

// The second order of a field about a point, and what it may be wrong by within the ball it was made for.
struct LocalField {
    double value = 0, slack = 0;
    dvec3 slope{0.0};
    dmat3 bend{0.0};
    double at(const dvec3& way) const { return value + glm::dot(slope, way) + 0.5 * glm::dot(way, bend * way); }
    LocalField moved(const dvec3& way) const { return {at(way), slack, slope + bend * way, bend}; }
};

class WindingTree {
  public:
    // Up to so many patches a voxel that the model leaves open is decided by all of them, which is exact. Beyond, the model's word counts:
    // nobody's part is wrong by more than kTolerance / sqrt(patches). What that adds up to has been about kAccuracy, as the signs differ
    // (20,000 patches, settings beside this one: 0.008 strewn about, 0.023 along a sphere); it is no bound.
    static constexpr size_t kExact = 1024;
    static constexpr double kTolerance = 0.15, kAccuracy = 0.02;  // turns

    // Patches are triangles [ends[k - 1], ends[k]). Refers to the caller's memory. Throws std::bad_alloc.
    WindingTree(std::span<const Corners> triangles, std::span<const uint32_t> ends);

    // As BoundaryCaps::correct. `goOn(share done)` is asked now and then on the calling thread; false ends it, and the result is false.
    bool correct(const ColumnCrossings& crossings, VoxelGrid& grid, const std::function<bool(double)>& goOn) const;
    double winding(const dvec3& p) const;  // of all, by every triangle

  private:
    // Some patches, consecutive in order_.
    struct Node {
        uint32_t first = 0, end = 0, children = 0;  // the first of two, or 0
        dvec3 centre{0.0};
        double radius = 0, area = 0;
        dvec3 dipole{0.0}, pull{0.0};
        dmat3 second{0.0};
        std::array<double, 10> third{};
    };
    struct Patch {
        dvec3 centre{0.0};
        double radius = 0, area = 0;
        uint32_t first = 0, end = 0;
    };
    struct Cell;
    class Descent;
    void build(uint32_t node, uint32_t first, uint32_t end);
    void measure(Node& node) const;
    double winding(const Patch& patch, const dvec3& p) const;

    std::span<const Corners> triangles_;
    std::vector<Patch> patches_;  // in the order of the nodes
    std::vector<Node> nodes_;
};

}  // namespace rivulet
