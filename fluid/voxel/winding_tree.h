// The part of many caps in the winding number: a tree over the caps, its nodes as dipoles with two further moments (Barill et al. 2018).
// Cubes of voxels share one second-order model of all far nodes.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <numbers>
#include <span>
#include <vector>

#include "fluid/voxel/crossings.h"
#include "fluid/voxel/voxel_grid.h"

namespace rivulet {

inline constexpr double kWindingRounding = 1e-9;  // turns
inline constexpr double kFullSphere = 4.0 * std::numbers::pi;

// From the origin.
inline double distanceToSegment(const dvec3& a, const dvec3& b) {
    const dvec3 ab = b - a;
    const double along = -glm::dot(a, ab), all = glm::dot(ab, ab);
    return glm::length(a + ab * (all > 0.0 ? std::clamp(along / all, 0.0, 1.0) : 0.0));
}

// Second-order expansion of a field about a point, and the bound of its error (`slack`) within the ball it was made for.
struct LocalField {
    double value = 0, slack = 0;
    dvec3 slope{0.0};
    dmat3 bend{0.0};
    double at(const dvec3& way) const { return value + glm::dot(slope, way) + 0.5 * glm::dot(way, bend * way); }
    LocalField moved(const dvec3& way) const { return {at(way), slack, slope + bend * way, bend}; }
};

class WindingTree {
  public:
    // Up to kExact patches, a voxel that the model leaves open is decided by all of them, which is exact. Above, the model decides: the
    // part of each patch has an error of at most kTolerance / sqrt(patches). Because signs differ, the measured sum is about kAccuracy
    // (20,000 patches, settings close to this one: 0.008 for jittered patches, 0.023 along a sphere); this is no bound.
    static constexpr size_t kExact = 1024;
    static constexpr double kTolerance = 0.15, kAccuracy = 0.02;  // turns

    // Patches are triangles [ends[k - 1], ends[k]). Refers to the caller's memory. Throws std::bad_alloc.
    WindingTree(std::span<const Corners> triangles, std::span<const uint32_t> ends);

    // See BoundaryCaps::correct. `goOn(share done)` is called repeatedly on the calling thread; false ends the work, and the result is
    // false.
    bool correct(const ColumnCrossings& crossings, VoxelGrid& grid, const std::function<bool(double)>& goOn) const;
    double winding(const dvec3& p) const;  // of all patches, exact

  private:
    // Consecutive patches of patches_.
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
