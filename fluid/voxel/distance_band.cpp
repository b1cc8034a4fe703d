// BrickPoints of 4^3 points in layers, each brick with the triangles that could be nearest to one of its points; each brick in 8 cubes of
// 2^3 points, whose middles sieve the brick's triangles again. Distance changes by no more than one moves: who is further from
// a middle than the nearest by more than a diagonal is nearest to none of the points around it.
#include "fluid/voxel/distance_band.h"

#include <oneapi/tbb/enumerable_thread_specific.h>
#include <oneapi/tbb/parallel_for.h>

#include <array>

namespace rivulet {
namespace {

constexpr int kEdge = DistanceBand::kBrick;
constexpr double kMiddle = 0.5 * (kEdge - 1);        // of a brick, from its first point
constexpr double kBrickRadius = 2.5980762113533160;  // sqrt(3) kMiddle: from there to its corners
constexpr double kCubeRadius = 0.8660254037844386;
constexpr double kToCube = 1.7320508075688772;  // from a brick's middle to its cubes'
constexpr double kSlack = 1e-6;                 // voxels: what sieves give away to rounding

struct Nearest {
    double square = 0;  // of the distance
    uint32_t target = kNoTriangle;
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

// In 0 or 1: whether a brick is to be done.
bool flagged(std::span<const uint8_t> flags, size_t brick) { return flags.empty() || flags[brick] != 0; }

// Memory a thread keeps from layer to layer. `bricks`, `kept` and `near` index `targets`.
struct Workspace {
    std::vector<Target> targets;   // that reach the layer
    std::vector<uint32_t> listed;  // of each target: its place in the list
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

struct Bake {
    const DistanceBand& band;
    const GridTriangles& triangles;
    std::span<const uint8_t> surfaces;
    std::span<const uint32_t> numbers;
    std::span<const uint8_t> flags;
    std::span<uint8_t> reached;
    const BandPoints& out;
    ivec3 points;
    double width;  // of the band, voxels
    float voxel, metres;
    std::vector<size_t> layerStart;  // layerStart[l] .. layerStart[l + 1]: the part of inLayer that reaches layer l of bricks, in order
    std::vector<uint32_t> inLayer;

    void run() {
        sortIntoLayers();
        tbb::enumerable_thread_specific<Workspace> workspaces;
        tbb::parallel_for(0, band.bricks().z, [&](int layer) { bakeLayer(layer, workspaces.local()); });
    }

    void sortIntoLayers() {
        const auto layers = static_cast<size_t>(band.bricks().z);
        layerStart.assign(layers + 1, 0);
        const auto forLayers = [&](const auto& body) {
            for (size_t k = 0; k < triangles.size(); ++k) {
                const GridTriangle t = triangles[k];
                ivec3 first, last;
                band.reach(t.low(), t.high(), first, last);
                for (int layer = first.z; layer <= last.z; ++layer) body(static_cast<size_t>(layer), static_cast<uint32_t>(k));
            }
        };
        forLayers([&](size_t layer, uint32_t) { ++layerStart[layer + 1]; });
        for (size_t l = 1; l < layerStart.size(); ++l) layerStart[l] += layerStart[l - 1];
        inLayer.resize(layerStart.back());
        std::vector<size_t> next(layerStart.begin(), layerStart.end() - 1);
        forLayers([&](size_t layer, uint32_t triangle) { inLayer[next[layer]++] = triangle; });
    }

    void bakeLayer(int layer, Workspace& work) const {
        const auto l = static_cast<size_t>(layer);
        const ivec3& bricks = band.bricks();
        work.targets.clear();
        work.listed.clear();
        work.bricks.resize(static_cast<size_t>(bricks.x) * static_cast<size_t>(bricks.y));
        for (auto& entries : work.bricks) entries.clear();
        for (size_t k = layerStart[l]; k < layerStart[l + 1]; ++k) enter(inLayer[k], layer, work);
        for (int y = 0; y < bricks.y; ++y) {
            for (int x = 0; x < bricks.x; ++x) bakeBrick({x, y, layer}, work);
        }
    }

    void enter(uint32_t k, int layer, Workspace& work) const {
        const GridTriangle triangle = triangles[k];
        const auto place = static_cast<uint32_t>(work.targets.size());
        const Target& target = work.targets.emplace_back(triangle);
        work.listed.push_back(k);
        ivec3 first, last;
        band.reach(triangle.low(), triangle.high(), first, last);
        for (int y = first.y; y <= last.y; ++y) {
            for (int x = first.x; x <= last.x; ++x) {
                if (!flagged(flags, band.brickIndex({x, y, layer}))) continue;
                if (!target.beyond(dvec3(x * kEdge, y * kEdge, layer * kEdge) + kMiddle, width + kBrickRadius))
                    work.bricks[band.brickIndex({x, y, 0})].push_back(place);
            }
        }
    }

    void bakeBrick(const ivec3& brick, Workspace& work) const {
        const size_t index = band.brickIndex(brick);
        if (!flagged(flags, index)) return;
        const std::vector<uint32_t>& entries = work.bricks[band.brickIndex({brick.x, brick.y, 0})];
        if (!reached.empty()) reached[index] = entries.empty() ? 0 : 1;
        if (flags.empty() && entries.empty()) return;
        BrickPoints best;
        const dvec3 middle = dvec3(brick * kEdge) + kMiddle;
        const double nearest = sieve(work.targets, entries, middle, kBrickRadius, width + kBrickRadius, work.kept);
        for (int cube = 0; cube < 8 && !work.kept.empty(); ++cube)
            bakeCube(brick, ivec3(cube & 1, (cube >> 1) & 1, cube >> 2) * 2, nearest, work, best);
        store(brick, best, work);
    }

    // `first`: the cube's low corner in the brick. `fromBrick`: the nearest triangle's distance from the brick's middle.
    void bakeCube(const ivec3& brick, const ivec3& first, double fromBrick, Workspace& work, BrickPoints& best) const {
        const dvec3 corner(brick * kEdge + first);
        sieve(work.targets, work.kept, corner + 0.5, kCubeRadius, std::min(width + kCubeRadius, fromBrick + kToCube), work.near);
        double reach = width;
        for (int k = 0; k < 8; ++k) {
            const ivec3 at((k ^ (k >> 1)) & 1, ((k >> 1) ^ (k >> 2)) & 1, k >> 2);  // each a step from the one before
            const dvec3 point = corner + dvec3(at);
            Nearest nearest{width * width, kNoTriangle};
            for (uint32_t n : work.near) {
                const Target& target = work.targets[n];
                if (target.beyond(point, reach)) continue;
                const double distance = target.squaredDistance(point);
                if (distance < nearest.square || (distance == nearest.square && n < nearest.target)) {
                    nearest = {distance, n};
                    reach = std::min(reach, std::sqrt(distance));
                }
            }
            best[static_cast<size_t>(((first.z + at.z) * kEdge + first.y + at.y) * kEdge + first.x + at.x)] = nearest;
            reach = std::min(width, reach + 1.0);  // the next point's distance is no more
        }
    }

    void store(const ivec3& brick, const BrickPoints& best, const Workspace& work) const {
        const ivec3 first = brick * kEdge;
        const ivec3 end = glm::min(first + ivec3(kEdge), points);
        for (int z = first.z; z < end.z; ++z) {
            for (int y = first.y; y < end.y; ++y) {
                const size_t row =
                    (static_cast<size_t>(z) * static_cast<size_t>(points.y) + static_cast<size_t>(y)) * static_cast<size_t>(points.x);
                for (int x = first.x; x < end.x; ++x) {
                    const size_t at = row + static_cast<size_t>(x);
                    const Nearest& nearest = best[static_cast<size_t>(((z - first.z) * kEdge + (y - first.y)) * kEdge + (x - first.x))];
                    const bool none = nearest.target == kNoTriangle;
                    const uint32_t k = none ? 0 : work.listed[nearest.target];
                    out.distance[at] = none ? metres : std::min(static_cast<float>(std::sqrt(nearest.square)) * voxel, metres);
                    out.normal[at] = none ? 0
                                          : packNormal(work.targets[nearest.target].away(dvec3(x, y, z)),
                                                       surfaces.empty() ? 0 : surfaces[triangles.owner(k)]);
                    if (!out.nearest.empty()) out.nearest[at] = none ? kNoTriangle : (numbers.empty() ? k : numbers[k]);
                }
            }
        }
    }
};

}  // namespace

DistanceBand::DistanceBand(const VoxelGrid& grid, float band)
    : points_(grid.size + ivec3(1)), bricks_((points_ + ivec3(kBrick - 1)) / kBrick), voxel_(grid.voxel), band_(band) {}

void DistanceBand::reach(const dvec3& low, const dvec3& high, ivec3& first, ivec3& last) const {
    const double width = static_cast<double>(band_) / static_cast<double>(voxel_) + 1e-6;
    for (int k = 0; k < 3; ++k) {
        first[k] = static_cast<int>(std::max(0.0, std::floor((low[k] - width - (kBrick - 1)) / kBrick)));
        last[k] = static_cast<int>(std::min(bricks_[k] - 1.0, std::floor((high[k] + width) / kBrick)));
    }
}

void DistanceBand::markReach(const GridTriangle& triangle, std::span<uint8_t> flags) const {
    const double width = static_cast<double>(band_) / static_cast<double>(voxel_);
    const Target target(triangle);
    ivec3 first, last;
    reach(triangle.low(), triangle.high(), first, last);
    for (int z = first.z; z <= last.z; ++z) {
        for (int y = first.y; y <= last.y; ++y) {
            for (int x = first.x; x <= last.x; ++x) {
                uint8_t& flag = flags[brickIndex({x, y, z})];
                if (flag == 0 && !target.beyond(dvec3(x * kEdge, y * kEdge, z * kEdge) + kMiddle, width + kBrickRadius)) flag = 1;
            }
        }
    }
}

void DistanceBand::bake(const GridTriangles& triangles, std::span<const uint8_t> surfaces, std::span<const uint32_t> numbers,
                        std::span<const uint8_t> flags, std::span<uint8_t> reached, const BandPoints& out) const {
    const double width = static_cast<double>(band_) / static_cast<double>(voxel_);
    Bake{*this, triangles, surfaces, numbers, flags, reached, out, points_, width, voxel_, band_, {}, {}}.run();
}

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

}  // namespace rivulet
