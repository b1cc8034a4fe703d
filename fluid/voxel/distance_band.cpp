// BrickPoints of 4^3 points in layers, each brick with the triangles that could be nearest to one of its points; each brick in 8 cubes of
// 2^3 points, whose middles sieve the brick's triangles again. Distance changes by no more than one moves: who is further from
// a middle than the nearest by more than a diagonal is nearest to none of the points around it.
#include "fluid/voxel/distance_band.h"

#include <oneapi/tbb/enumerable_thread_specific.h>
#include <oneapi/tbb/parallel_for.h>

#include <array>

namespace rivulet {
namespace {

constexpr int kEdge = 4;                             // points of a brick, each way
constexpr double kMiddle = 0.5 * (kEdge - 1);        // of a brick, from its first point
constexpr double kBrickRadius = 2.5980762113533160;  // sqrt(3) kMiddle: from there to its corners
constexpr double kCubeRadius = 0.8660254037844386;
constexpr double kToCube = 1.7320508075688772;  // from a brick's middle to its cubes'
constexpr double kSlack = 1e-6;                 // voxels: what sieves give away to rounding

constexpr uint32_t kNone = std::numeric_limits<uint32_t>::max();

struct Nearest {
    double square = 0;  // of the distance
    uint32_t target = kNone;
};
using BrickPoints = std::array<Nearest, size_t{kEdge} * kEdge * kEdge>;

double square(const dvec3& v) { return glm::dot(v, v); }

// What distances to one triangle need, worked out once.
struct Target {
    dvec3 centre{0.0}, unit{0.0};  // unit: of the plane's normal; zero if the triangle has no area
    double radius;                 // about the centre, of a disc that holds the triangle
    dvec3 a{0.0}, ab{0.0}, ac{0.0}, bc{0.0};
    double abab, abac, acac, area, perAb, perAc, perBc;

    explicit Target(const GridTriangle& t) : a(t.a), ab(t.ab), ac(t.ac), bc(t.ac - t.ab) {
        const dvec3 middle = (ab + ac) / 3.0;
        centre = a + middle;
        radius = std::sqrt(std::max(square(middle), std::max(square(middle - ab), square(middle - ac))));
        abab = square(ab);
        abac = glm::dot(ab, ac);
        acac = square(ac);
        const double bcbc = square(bc);
        const dvec3 normal = glm::cross(ab, ac);
        // Without area (an angle below 1e-7) its edges are all there is: nothing is inside.
        const bool flat = square(normal) <= 1e-14 * abab * acac;
        area = flat ? -1.0 : abab * acac - abac * abac;
        if (!flat) unit = normal / std::sqrt(square(normal));
        perAb = abab > 0.0 ? 1.0 / abab : 0.0;
        perAc = acac > 0.0 ? 1.0 / acac : 0.0;
        perBc = bcbc > 0.0 ? 1.0 / bcbc : 0.0;
    }

    // To the plane where the point projects inside, else to the nearest edge.
    double squaredDistance(const dvec3& point) const {
        const dvec3 q = point - a;
        const dvec3 fromB = q - ab;
        const double onAb = glm::dot(ab, q), onAc = glm::dot(ac, q);
        const double v = acac * onAb - abac * onAc;
        const double w = abab * onAc - abac * onAb;
        if (v >= 0.0 && w >= 0.0 && v + w <= area) {
            const double height = glm::dot(unit, q);
            return height * height;
        }
        const double alongAb = std::min(1.0, std::max(0.0, onAb * perAb));
        const double alongAc = std::min(1.0, std::max(0.0, onAc * perAc));
        const double alongBc = std::min(1.0, std::max(0.0, glm::dot(bc, fromB) * perBc));
        return std::min(square(q - ab * alongAb), std::min(square(q - ac * alongAc), square(fromB - bc * alongBc)));
    }

    // From the triangle's nearest point to `point`.
    dvec3 away(const dvec3& point) const {
        const dvec3 q = point - a;
        const dvec3 fromB = q - ab;
        const double onAb = glm::dot(ab, q), onAc = glm::dot(ac, q);
        const double v = acac * onAb - abac * onAc;
        const double w = abab * onAc - abac * onAb;
        if (v >= 0.0 && w >= 0.0 && v + w <= area) return unit * glm::dot(unit, q);
        const std::array<dvec3, 3> ways{q - ab * std::min(1.0, std::max(0.0, onAb * perAb)),
                                        q - ac * std::min(1.0, std::max(0.0, onAc * perAc)),
                                        fromB - bc * std::min(1.0, std::max(0.0, glm::dot(bc, fromB) * perBc))};
        return *std::min_element(ways.begin(), ways.end(), [](const dvec3& x, const dvec3& y) { return square(x) < square(y); });
    }

    // True only if the whole triangle is further than `reach` from the point, because the disc around it in its plane is:
    // across the plane by h > reach, or along it by more than sqrt(reach^2 - h^2) + radius (squared twice, for speed).
    bool beyond(const dvec3& point, double reach) const {
        const double far = reach + kSlack;
        const dvec3 q = point - centre;
        const double excess = square(q) - far * far - radius * radius;
        const double height = glm::dot(unit, q);
        const double left = far * far - height * height;
        return (excess > 0.0) & ((left < 0.0) | (excess * excess > 4.0 * radius * radius * left));
    }
};

// Memory a thread keeps from layer to layer. `bricks`, `kept` and `near` index `targets`.
struct Workspace {
    std::vector<Target> targets;   // that reach the layer
    std::vector<uint8_t> surface;  // of each target
    std::vector<std::vector<uint32_t>> bricks;
    std::vector<uint32_t> kept, near;
};

// Of `from`, those that may be nearest to a point within `radius` of `middle`, the nearest to `middle` itself first, into `to`.
// `nearest`: no further than this is of interest. Returns the distance from `middle`, or that.
double sieve(const std::vector<Target>& targets, const std::vector<uint32_t>& from, const dvec3& middle, double radius, double nearest,
             std::vector<uint32_t>& to) {
    to.clear();
    for (uint32_t k : from) {
        const Target& target = targets[k];
        if (target.beyond(middle, nearest + 2.0 * radius)) continue;
        to.push_back(k);
        if (target.beyond(middle, nearest)) continue;
        const double distance = std::sqrt(target.squaredDistance(middle));
        if (distance < nearest) {
            nearest = distance;
            std::swap(to.front(), to.back());
        }
    }
    std::erase_if(to, [&](uint32_t k) { return targets[k].beyond(middle, nearest + 2.0 * radius); });
    return nearest;
}

class BandBaker {
  public:
    BandBaker(const GridTriangles& triangles, std::span<const uint8_t> surfaces, const ivec3& size, double band)
        : triangles_(triangles),
          surfaces_(surfaces),
          points_(size + ivec3(1)),
          bricks_((points_ + ivec3(kEdge - 1)) / kEdge),
          band_(band) {}

    DistanceBand bake() {
        const auto total = static_cast<size_t>(points_.x) * static_cast<size_t>(points_.y) * static_cast<size_t>(points_.z);
        result_.distance.assign(total, static_cast<float>(band_));
        result_.normal.assign(total, 0);
        sortIntoLayers();
        tbb::enumerable_thread_specific<Workspace> workspaces;
        tbb::parallel_for(0, bricks_.z, [&](int layer) { bakeLayer(layer, workspaces.local()); });
        return std::move(result_);
    }

  private:
    // BrickPoints along axis k that a triangle can reach.
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
        work.targets.clear();
        work.surface.clear();
        work.bricks.resize(static_cast<size_t>(bricks_.x) * static_cast<size_t>(bricks_.y));
        for (auto& entries : work.bricks) entries.clear();
        for (size_t k = layerStart_[l]; k < layerStart_[l + 1]; ++k) {
            work.surface.push_back(surfaces_.empty() ? uint8_t{0} : surfaces_[triangles_.owner(inLayer_[k])]);
            enter(triangles_[inLayer_[k]], layer, work);
        }
        for (int y = 0; y < bricks_.y; ++y) {
            for (int x = 0; x < bricks_.x; ++x) bakeBrick({x, y, layer}, work);
        }
    }

    void enter(const GridTriangle& triangle, int layer, Workspace& work) const {
        const auto k = static_cast<uint32_t>(work.targets.size());
        const Target& target = work.targets.emplace_back(triangle);
        const dvec3 low = triangle.low(), high = triangle.high();
        const ivec2 xs = reached(low.x, high.x, 0), ys = reached(low.y, high.y, 1);
        for (int y = ys.x; y <= ys.y; ++y) {
            for (int x = xs.x; x <= xs.y; ++x) {
                if (!target.beyond(dvec3(x * kEdge, y * kEdge, layer * kEdge) + kMiddle, band_ + kBrickRadius))
                    work.bricks[brickIndex(x, y)].push_back(k);
            }
        }
    }

    void bakeBrick(const ivec3& brick, Workspace& work) {
        const std::vector<uint32_t>& entries = work.bricks[brickIndex(brick.x, brick.y)];
        if (entries.empty()) return;
        const dvec3 middle = dvec3(brick * kEdge) + kMiddle;
        const double nearest = sieve(work.targets, entries, middle, kBrickRadius, band_ + kBrickRadius, work.kept);
        if (work.kept.empty()) return;
        BrickPoints best;
        for (int cube = 0; cube < 8; ++cube) bakeCube(brick, ivec3(cube & 1, (cube >> 1) & 1, cube >> 2) * 2, nearest, work, best);
        store(brick, best, work);
    }

    // `first`: the cube's low corner in the brick. `fromBrick`: the nearest triangle's distance from the brick's middle.
    void bakeCube(const ivec3& brick, const ivec3& first, double fromBrick, Workspace& work, BrickPoints& best) const {
        const dvec3 corner(brick * kEdge + first);
        sieve(work.targets, work.kept, corner + 0.5, kCubeRadius, std::min(band_ + kCubeRadius, fromBrick + kToCube), work.near);
        double reach = band_;
        for (int k = 0; k < 8; ++k) {
            const ivec3 at((k ^ (k >> 1)) & 1, ((k >> 1) ^ (k >> 2)) & 1, k >> 2);  // each a step from the one before
            const dvec3 point = corner + dvec3(at);
            Nearest nearest{band_ * band_, kNone};
            for (uint32_t n : work.near) {
                const Target& target = work.targets[n];
                if (target.beyond(point, reach)) continue;
                const double distance = target.squaredDistance(point);
                if (distance < nearest.square) {
                    nearest = {distance, n};
                    reach = std::min(reach, std::sqrt(distance));
                }
            }
            best[static_cast<size_t>(((first.z + at.z) * kEdge + first.y + at.y) * kEdge + first.x + at.x)] = nearest;
            reach = std::min(band_, reach + 1.0);  // the next point's distance is no more
        }
    }

    void store(const ivec3& brick, const BrickPoints& best, const Workspace& work) {
        const ivec3 first = brick * kEdge;
        const ivec3 end = glm::min(first + ivec3(kEdge), points_);
        for (int z = first.z; z < end.z; ++z) {
            for (int y = first.y; y < end.y; ++y) {
                const size_t row =
                    (static_cast<size_t>(z) * static_cast<size_t>(points_.y) + static_cast<size_t>(y)) * static_cast<size_t>(points_.x);
                for (int x = first.x; x < end.x; ++x) {
                    const Nearest& nearest = best[static_cast<size_t>(((z - first.z) * kEdge + (y - first.y)) * kEdge + (x - first.x))];
                    if (nearest.target == kNone) continue;
                    result_.distance[row + static_cast<size_t>(x)] = static_cast<float>(std::sqrt(nearest.square));
                    result_.normal[row + static_cast<size_t>(x)] =
                        packNormal(work.targets[nearest.target].away(dvec3(x, y, z)), work.surface[nearest.target]);
                }
            }
        }
    }

    size_t brickIndex(int x, int y) const { return static_cast<size_t>(y) * static_cast<size_t>(bricks_.x) + static_cast<size_t>(x); }

    const GridTriangles& triangles_;
    std::span<const uint8_t> surfaces_;
    ivec3 points_, bricks_;
    double band_;
    DistanceBand result_;
    std::vector<size_t> layerStart_;
    std::vector<uint32_t> inLayer_;
};

}  // namespace

uint32_t packNormal(const dvec3& direction, uint32_t surface) {
    const double sum = std::abs(direction.x) + std::abs(direction.y) + std::abs(direction.z);
    if (!(sum > 0.0)) return surface << 28U;
    const dvec3 d = direction / sum;
    double x = d.x, y = d.y;
    if (d.z < 0.0) {
        x = (1.0 - std::abs(d.y)) * (d.x < 0.0 ? -1.0 : 1.0);
        y = (1.0 - std::abs(d.x)) * (d.y < 0.0 ? -1.0 : 1.0);
    }
    // Of the four codes around, the one whose direction has the largest cosine; it is positive for all.
    const double lowX = std::min(8190.0, std::floor(x * 8191.0)), lowY = std::min(8190.0, std::floor(y * 8191.0));
    double best = -1.0;
    uint32_t code = 0;
    for (int k = 0; k < 4; ++k) {
        const double u = lowX + (k & 1), v = lowY + (k >> 1);
        const double z = 8191.0 - std::abs(u) - std::abs(v);
        const double fold = std::max(-z, 0.0);
        const dvec3 n(u < 0.0 ? u + fold : u - fold, v < 0.0 ? v + fold : v - fold, z);
        const double along = glm::dot(n, d);
        const double cosine = along * along / glm::dot(n, n);
        if (cosine > best) {
            best = cosine;
            code = static_cast<uint32_t>(static_cast<int>(u) + 8191) | static_cast<uint32_t>(static_cast<int>(v) + 8191) << 14U;
        }
    }
    return code | surface << 28U;
}

DistanceBand distanceBand(const GridTriangles& triangles, std::span<const uint8_t> surfaces, const ivec3& size, double band) {
    return BandBaker(triangles, surfaces, size, band).bake();
}

}  // namespace rivulet
