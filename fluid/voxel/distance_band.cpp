// Bricks of 4^3 points, each with the triangles that can reach it, nearest first: a brick stops at the first that is out of its reach.
#include "fluid/voxel/distance_band.h"

#include <oneapi/tbb/enumerable_thread_specific.h>
#include <oneapi/tbb/parallel_for.h>

#include <array>

namespace rivulet {
namespace {

constexpr int kEdge = 4;                       // points of a brick, each way
constexpr int kPoints = kEdge * kEdge * kEdge;
constexpr double kMiddle = 0.5 * (kEdge - 1);  // of a brick, from its first point
constexpr double kRadius = 2.5980762113533160;  // sqrt(3) kMiddle: from there to its corners

// What squared distances to one triangle need, worked out once.
struct Target {
    GridTriangle t;
    dvec3 bc{0.0}, normal{0.0};
    double abab, abac, acac, area, perAb, perAc, perBc, perNormal;

    explicit Target(const GridTriangle& triangle) : t(triangle) {
        bc = t.ac - t.ab;
        normal = glm::cross(t.ab, t.ac);
        abab = glm::dot(t.ab, t.ab);
        abac = glm::dot(t.ab, t.ac);
        acac = glm::dot(t.ac, t.ac);
        const double bcbc = glm::dot(bc, bc);
        const double square = glm::dot(normal, normal);
        // Without area (an angle below 1e-7) its edges are all there is: nothing is inside.
        const bool flat = square <= 1e-14 * abab * acac;
        area = flat ? -1.0 : abab * acac - abac * abac;
        perNormal = flat ? 0.0 : 1.0 / square;
        perAb = abab > 0.0 ? 1.0 / abab : 0.0;
        perAc = acac > 0.0 ? 1.0 / acac : 0.0;
        perBc = bcbc > 0.0 ? 1.0 / bcbc : 0.0;
    }

    // Of the point at q from corner a: to the plane where it projects inside, else to the nearest edge.
    double squaredDistance(double x, double y, double z) const {
        const double onAb = t.ab.x * x + t.ab.y * y + t.ab.z * z;
        const double onAc = t.ac.x * x + t.ac.y * y + t.ac.z * z;
        const double onBc = bc.x * (x - t.ab.x) + bc.y * (y - t.ab.y) + bc.z * (z - t.ab.z);
        const double alongAb = std::min(1.0, std::max(0.0, onAb * perAb));
        const double alongAc = std::min(1.0, std::max(0.0, onAc * perAc));
        const double alongBc = std::min(1.0, std::max(0.0, onBc * perBc));
        const double toAb = square(x - t.ab.x * alongAb, y - t.ab.y * alongAb, z - t.ab.z * alongAb);
        const double toAc = square(x - t.ac.x * alongAc, y - t.ac.y * alongAc, z - t.ac.z * alongAc);
        const double toBc = square(x - t.ab.x - bc.x * alongBc, y - t.ab.y - bc.y * alongBc, z - t.ab.z - bc.z * alongBc);
        const double height = normal.x * x + normal.y * y + normal.z * z;
        const double v = acac * onAb - abac * onAc;
        const double w = abab * onAc - abac * onAb;
        const double toEdges = std::min(toAb, std::min(toAc, toBc));
        const bool inside = (v >= 0.0) & (w >= 0.0) & (v + w <= area);
        return inside ? height * height * perNormal : toEdges;
    }
    static double square(double x, double y, double z) { return x * x + y * y + z * z; }
};

struct Entry {
    double fromMiddle;  // distance of the triangle from the brick's middle
    uint32_t triangle;
    bool operator<(const Entry& other) const {
        return fromMiddle != other.fromMiddle ? fromMiddle < other.fromMiddle : triangle < other.triangle;
    }
};

// Memory a thread keeps from layer to layer.
struct Workspace {
    std::vector<std::vector<Entry>> bricks;
};

class BandBaker {
  public:
    BandBaker(const GridTriangles& triangles, const ivec3& size, double band)
        : triangles_(triangles), points_(size + ivec3(1)), bricks_((points_ + ivec3(kEdge - 1)) / kEdge), band_(band) {}

    std::vector<float> bake() {
        const auto total = static_cast<size_t>(points_.x) * static_cast<size_t>(points_.y) * static_cast<size_t>(points_.z);
        distance_.assign(total, static_cast<float>(band_));
        sortIntoLayers();
        tbb::enumerable_thread_specific<Workspace> workspaces;
        tbb::parallel_for(0, bricks_.z, [&](int layer) { bakeLayer(layer, workspaces.local()); });
        return std::move(distance_);
    }

  private:
    // Bricks along axis k that a triangle can reach.
    ivec2 reached(double low, double high, int k) const {
        const double first = std::floor((low - band_ - (kEdge - 1)) / kEdge), last = std::floor((high + band_) / kEdge);
        return {static_cast<int>(std::max(0.0, first)), static_cast<int>(std::min(bricks_[k] - 1.0, last))};
    }

    // layerStart_[l] .. layerStart_[l + 1]: the triangles that reach layer l of bricks, in order.
    void sortIntoLayers() {
        layerStart_.assign(static_cast<size_t>(bricks_.z) + 1, 0);
        const auto forLayers = [&](const auto& body) {
            for (size_t k = 0; k < triangles_.size(); ++k) {
                const GridTriangle t = triangles_[k];
                const ivec2 range = reached(t.low().z, t.high().z, 2);
                for (int layer = range.x; layer <= range.y; ++layer) body(static_cast<size_t>(layer), static_cast<uint32_t>(k));
            }
        };
        forLayers([&](size_t layer, uint32_t) { ++layerStart_[layer + 1]; });
        for (size_t l = 1; l < layerStart_.size(); ++l) layerStart_[l] += layerStart_[l - 1];
        inLayer_.resize(layerStart_.back());
        std::vector<size_t> next(layerStart_.begin(), layerStart_.end() - 1);
        forLayers([&](size_t layer, uint32_t triangle) { inLayer_[next[layer]++] = triangle; });
    }

    void bakeLayer(int layer, Workspace& work) {
        const auto l = static_cast<size_t>(layer);
        if (layerStart_[l] == layerStart_[l + 1]) return;
        work.bricks.resize(static_cast<size_t>(bricks_.x) * static_cast<size_t>(bricks_.y));
        for (auto& entries : work.bricks) entries.clear();
        for (size_t k = layerStart_[l]; k < layerStart_[l + 1]; ++k) enter(inLayer_[k], layer, work);
        for (int y = 0; y < bricks_.y; ++y) {
            for (int x = 0; x < bricks_.x; ++x) bakeBrick({x, y, layer}, work.bricks[brickIndex(x, y)]);
        }
    }

    void enter(uint32_t index, int layer, Workspace& work) const {
        const Target target(triangles_[index]);
        const dvec3 low = target.t.low(), high = target.t.high();
        const ivec2 xs = reached(low.x, high.x, 0), ys = reached(low.y, high.y, 1);
        for (int y = ys.x; y <= ys.y; ++y) {
            for (int x = xs.x; x <= xs.y; ++x) {
                const dvec3 middle = dvec3(x * kEdge, y * kEdge, layer * kEdge) + kMiddle - target.t.a;
                const double distance = std::sqrt(target.squaredDistance(middle.x, middle.y, middle.z));
                if (distance <= band_ + kRadius) work.bricks[brickIndex(x, y)].push_back({distance, index});
            }
        }
    }

    void bakeBrick(const ivec3& brick, std::vector<Entry>& entries) {
        if (entries.empty()) return;
        std::sort(entries.begin(), entries.end());
        std::array<double, kPoints> best;
        best.fill(band_ * band_);
        double worst = band_;
        for (const Entry& entry : entries) {
            if (entry.fromMiddle - kRadius > worst) break;
            const Target target(triangles_[entry.triangle]);
            const dvec3 corner = dvec3(brick * kEdge) - target.t.a;
            double worstSquare = 0;
            for (int row = 0; row < kEdge * kEdge; ++row) {
                const double y = corner.y + row % kEdge, z = corner.z + row / kEdge;  // NOLINT(bugprone-integer-division)
                double* of = best.data() + row * kEdge;
                for (int x = 0; x < kEdge; ++x) of[x] = std::min(of[x], target.squaredDistance(corner.x + x, y, z));
                for (int x = 0; x < kEdge; ++x) worstSquare = std::max(worstSquare, of[x]);
            }
            worst = std::sqrt(worstSquare);
        }
        store(brick, best);
    }

    void store(const ivec3& brick, const std::array<double, kPoints>& best) {
        const ivec3 first = brick * kEdge;
        const ivec3 end = glm::min(first + ivec3(kEdge), points_);
        for (int z = first.z; z < end.z; ++z) {
            for (int y = first.y; y < end.y; ++y) {
                const size_t row = (static_cast<size_t>(z) * static_cast<size_t>(points_.y) + static_cast<size_t>(y)) * static_cast<size_t>(points_.x);
                for (int x = first.x; x < end.x; ++x) {
                    const int k = ((z - first.z) * kEdge + (y - first.y)) * kEdge + (x - first.x);
                    distance_[row + static_cast<size_t>(x)] = static_cast<float>(std::sqrt(best[static_cast<size_t>(k)]));
                }
            }
        }
    }

    size_t brickIndex(int x, int y) const { return static_cast<size_t>(y) * static_cast<size_t>(bricks_.x) + static_cast<size_t>(x); }

    const GridTriangles& triangles_;
    ivec3 points_, bricks_;
    double band_;
    std::vector<float> distance_;
    std::vector<size_t> layerStart_;
    std::vector<uint32_t> inLayer_;
};

}  // namespace

std::vector<float> distanceBand(const GridTriangles& triangles, const ivec3& size, double band) {
    return BandBaker(triangles, size, band).bake();
}

}  // namespace rivulet
