// Bricks of 4^3 points in layers, each brick with the triangles that could be nearest to one of its points;
// fluid/voxel/kernels/band_brick.cpp bakes one brick.
#include "fluid/voxel/distance_band.h"

#include <array>
#include <bit>
#include <memory>
#include <mutex>

#include "engine/core/parallel.h"
#include "fluid/voxel/kernels/band_brick.h"

RIVULET_BAND_UNIT(kernels_generic)
#if defined(RIVULET_HAS_AVX2)
RIVULET_BAND_UNIT(kernels_avx2)
RIVULET_BAND_UNIT(kernels_avx512)
#endif

namespace rivulet {
namespace {

constexpr int kEdge = DistanceBand::kBrick;
constexpr size_t kBrickPoints = size_t{kEdge} * kEdge * kEdge;
constexpr double kMiddle = 0.5 * (kEdge - 1);        // of a brick, from its first point
constexpr double kBrickRadius = 2.5980762113533160;  // sqrt(3) kMiddle: from the middle to the corners
constexpr size_t kTargetsAtOnce = size_t{1} << 20U;  // above this number each layer computes its own, to save memory

double square(const dvec3& v) { return glm::dot(v, v); }
dvec3 from(const double* v) { return {v[0], v[1], v[2]}; }
void to(double* v, const dvec3& d) {
    for (int k = 0; k < 3; ++k) v[k] = d[k];
}

BandKernels kernelsOf(Isa isa) {
#if defined(RIVULET_HAS_AVX2)
    if (isa == Isa::avx512) return kernels_avx512::bandKernels();
    if (isa == Isa::avx2) return kernels_avx2::bandKernels();
#endif
    static_cast<void>(isa);
    return kernels_generic::bandKernels();
}

struct Target {
    BandTarget exact;
    BandDisc disc;
};

// `width`: of the band. `furthest`: the largest coordinate of the grid.
Target targetOf(const GridTriangle& t, double width, double furthest) {
    Target target;
    BandTarget& r = target.exact;
    BandDisc& disc = target.disc;
    const dvec3 bc = t.ac - t.ab, middle = (t.ab + t.ac) / 3.0;
    to(r.a, t.a);
    to(r.ab, t.ab);
    to(r.ac, t.ac);
    to(r.bc, bc);
    r.abab = square(t.ab);
    r.abac = glm::dot(t.ab, t.ac);
    r.acac = square(t.ac);
    const double bcbc = square(bc);
    const dvec3 normal = glm::cross(t.ab, t.ac);
    // Without area: an angle below 1e-7.
    const bool flat = square(normal) <= 1e-14 * r.abab * r.acac;
    r.area = flat ? -1.0 : r.abab * r.acac - r.abac * r.abac;
    const dvec3 unit = flat ? dvec3(0.0) : normal / std::sqrt(square(normal));
    to(r.unit, unit);
    r.perAb = r.abab > 0.0 ? 1.0 / r.abab : 0.0;
    r.perAc = r.acac > 0.0 ? 1.0 / r.acac : 0.0;
    r.perBc = bcbc > 0.0 ? 1.0 / bcbc : 0.0;
    const double radius = std::sqrt(std::max(square(middle), std::max(square(middle - t.ab), square(middle - t.ac))));
    for (int k = 0; k < 3; ++k) {
        disc.centre[k] = static_cast<float>(t.a[k] + middle[k]);
        disc.normal[k] = static_cast<float>(unit[k]);
    }
    disc.radius = static_cast<float>(radius * 1.000001);
    // A brick in reach has its centre within `span`. The centre's error is at most one rounding of `furthest` along each axis; sums of
    // products of such floats have an error of 3e-6 of their square.
    const double span = radius + width + 3.0;
    disc.slack = static_cast<float>(4e-6 * span * span + 3e-7 * span * (furthest + radius));
    return target;
}

// Direction from the triangle's nearest point to `point`, of any length above 0; at the triangle itself, its normal.
dvec3 away(const BandTarget& t, const dvec3& point) {
    const dvec3 ab = from(t.ab), ac = from(t.ac), bc = from(t.bc);
    const dvec3 q = point - from(t.a);
    const dvec3 fromB = q - ab;
    const double onAb = glm::dot(ab, q), onAc = glm::dot(ac, q);
    const double v = t.acac * onAb - t.abac * onAc;
    const double w = t.abab * onAc - t.abac * onAb;
    if (v >= 0.0 && w >= 0.0 && v + w <= t.area) {
        const double height = glm::dot(from(t.unit), q);
        return height < 0.0 ? -from(t.unit) : from(t.unit);
    }
    const std::array<dvec3, 3> ways{q - ab * std::min(1.0, std::max(0.0, onAb * t.perAb)),
                                    q - ac * std::min(1.0, std::max(0.0, onAc * t.perAc)),
                                    fromB - bc * std::min(1.0, std::max(0.0, glm::dot(bc, fromB) * t.perBc))};
    const dvec3 way = *std::min_element(ways.begin(), ways.end(), [](const dvec3& x, const dvec3& y) { return square(x) < square(y); });
    return way == dvec3(0.0) ? (t.area < 0.0 ? dvec3(0.0, 0.0, 1.0) : from(t.unit)) : way;
}

// 0 or 1: 1 if the brick must be baked.
bool flagged(std::span<const uint8_t> flags, size_t brick) { return flags.empty() || flags[brick] != 0; }

// Bricks along each axis.
struct Reach {
    std::array<int16_t, 3> first{}, last{};
};

Reach reachOf(const DistanceBand& band, const GridTriangle& triangle) {
    Reach r;
    ivec3 first, last;
    band.reach(triangle.low(), triangle.high(), first, last);
    for (int k = 0; k < 3; ++k) {
        r.first[static_cast<size_t>(k)] = static_cast<int16_t>(std::min(first[k], 32767));
        r.last[static_cast<size_t>(k)] = static_cast<int16_t>(std::max(last[k], -1));
    }
    return r;
}

// Calls body(brick) for the bricks of layer z that the triangle may reach. `bits`: scratch memory.
template <class Body>
void forReached(const BandKernels& kernels, double width, const Reach& reach, const BandDisc& disc, int z, std::vector<uint32_t>& bits,
                const Body& body) {
    const int rows = reach.last[1] - reach.first[1] + 1;
    if (rows <= 0) return;
    if (bits.size() < static_cast<size_t>(rows)) bits.resize(static_cast<size_t>(rows));
    for (int x0 = reach.first[0]; x0 <= reach.last[0]; x0 += 8) {
        const auto middle = [](int brick) { return static_cast<float>(brick * kEdge) + static_cast<float>(kMiddle); };
        kernels.rows({&disc,
                      {middle(x0), middle(reach.first[1]), middle(z)},
                      static_cast<uint32_t>(rows),
                      static_cast<float>(width + kBrickRadius) * 1.000001F,
                      bits.data()});
        const uint32_t all = reach.last[0] - x0 >= 7 ? 0xFFU : (2U << static_cast<unsigned>(reach.last[0] - x0)) - 1U;
        for (int r = 0; r < rows; ++r) {
            for (uint32_t row = bits[static_cast<size_t>(r)] & all; row != 0; row &= row - 1)
                body(ivec3(x0 + std::countr_zero(row), reach.first[1] + r, z));
        }
    }
}

// Memory that a thread reuses from layer to layer.
struct Workspace {
    std::vector<BandTarget> targets;  // that reach the layer, unless all are computed once
    std::vector<BandDisc> discs;      // of each of these
    std::vector<uint32_t> bits;
    std::vector<uint32_t> listed;  // of each of these: its place in the list
    std::vector<std::vector<uint32_t>> bricks;
    std::vector<float> lower;
};

struct Bake {
    const DistanceBand& band;
    const BandKernels kernels;
    const GridTriangles& triangles;
    std::span<const uint8_t> surfaces;
    std::span<const uint32_t> numbers;
    std::span<const uint8_t> flags;
    std::span<uint8_t> reached;
    const BandPoints& out;
    ivec3 points;
    double width;     // of the band, voxels
    double furthest;  // of a grid's coordinates
    float voxel, metres;
    std::vector<BandTarget> all;     // of each triangle, or empty
    std::vector<BandDisc> allDiscs;  // of each of these
    std::vector<Reach> reaches;      // of each triangle
    std::vector<size_t> layerStart;  // layerStart[l] .. layerStart[l + 1]: the part of inLayer that reaches layer l of bricks, in order
    std::vector<uint32_t> inLayer;

    void run() {
        sortIntoLayers();
        if (triangles.size() <= kTargetsAtOnce) {
            all.resize(triangles.size());
            allDiscs.resize(triangles.size());
            parallelParts(all.size(), 256, [&](size_t begin, size_t end) {
                for (size_t k = begin; k != end; ++k) {
                    const Target target = targetOf(triangles[k], width, furthest);
                    all[k] = target.exact;
                    allDiscs[k] = target.disc;
                }
            });
        }
        // A loop within a layer may run a part of another layer on the same thread: a workspace belongs to a layer, not to a thread.
        std::mutex mutex;
        std::vector<std::unique_ptr<Workspace>> idle;
        parallelFor(0, band.bricks().z, [&](int layer) {
            std::unique_ptr<Workspace> work;
            {
                const std::scoped_lock lock(mutex);
                if (!idle.empty()) {
                    work = std::move(idle.back());
                    idle.pop_back();
                }
            }
            if (!work) work = std::make_unique<Workspace>();
            bakeLayer(layer, *work);
            const std::scoped_lock lock(mutex);
            idle.push_back(std::move(work));
        });
    }

    void sortIntoLayers() {
        const auto layers = static_cast<size_t>(band.bricks().z);
        layerStart.assign(layers + 1, 0);
        reaches.resize(triangles.size());
        parallelParts(reaches.size(), 1024, [&](size_t begin, size_t end) {
            for (size_t k = begin; k != end; ++k) reaches[k] = reachOf(band, triangles[k]);
        });
        const auto forLayers = [&](const auto& body) {
            for (size_t k = 0; k < reaches.size(); ++k) {
                for (int layer = reaches[k].first[2]; layer <= reaches[k].last[2]; ++layer)
                    body(static_cast<size_t>(layer), static_cast<uint32_t>(k));
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
        const size_t inIt = static_cast<size_t>(bricks.x) * static_cast<size_t>(bricks.y);
        if (flags.empty() ? layerStart[l] == layerStart[l + 1]
                          : std::all_of(&flags[l * inIt], &flags[l * inIt] + inIt, [](uint8_t flag) { return flag == 0; }))
            return;
        work.targets.clear();
        work.discs.clear();
        work.listed.clear();
        work.bricks.resize(inIt);
        for (auto& entries : work.bricks) entries.clear();
        for (size_t n = layerStart[l]; n < layerStart[l + 1]; ++n) {
            const uint32_t k = inLayer[n];
            uint32_t place = k;
            if (all.empty()) {
                place = static_cast<uint32_t>(work.targets.size());
                const Target target = targetOf(triangles[k], width, furthest);
                work.targets.push_back(target.exact);
                work.discs.push_back(target.disc);
                work.listed.push_back(k);
            }
            const BandDisc& disc = all.empty() ? work.discs.back() : allDiscs[k];
            forReached(kernels, width, reaches[k], disc, layer, work.bits, [&](const ivec3& b) {
                if (flagged(flags, band.brickIndex(b))) work.bricks[band.brickIndex({b.x, b.y, 0})].push_back(place);
            });
        }
        for (int y = 0; y < bricks.y; ++y) {
            for (int x = 0; x < bricks.x; ++x) bakeBrick({x, y, layer}, work);
        }
    }

    void bakeBrick(const ivec3& brick, Workspace& work) const {
        const size_t index = band.brickIndex(brick);
        if (!flagged(flags, index)) return;
        const std::vector<uint32_t>& entries = work.bricks[band.brickIndex({brick.x, brick.y, 0})];
        if (!reached.empty()) reached[index] = entries.empty() ? 0 : 1;
        if (flags.empty() && entries.empty()) return;
        if (work.lower.size() < 8 * entries.size()) work.lower.resize(8 * entries.size());
        std::array<double, kBrickPoints> squares;
        std::array<uint32_t, kBrickPoints> nearest;
        const ivec3 first = brick * kEdge;
        const BandTarget* targets = all.empty() ? work.targets.data() : all.data();
        const BandDisc* discs = all.empty() ? work.discs.data() : allDiscs.data();
        kernels.brick({targets,
                       discs,
                       entries.data(),
                       static_cast<uint32_t>(entries.size()),
                       {static_cast<double>(first.x), static_cast<double>(first.y), static_cast<double>(first.z)},
                       width,
                       work.lower.data(),
                       squares.data(),
                       nearest.data()});
        std::array<double, kBrickPoints> x, y, z;
        std::array<uint32_t, kBrickPoints> codes{};
        if (!entries.empty()) {
            for (size_t n = 0; n < kBrickPoints; ++n) {
                const auto i = static_cast<int>(n);
                const dvec3 point(first + ivec3(i % kEdge, i / kEdge % kEdge, i / (kEdge * kEdge)));
                const dvec3 direction = nearest[n] == kNoTarget ? dvec3(1.0) : away(targets[nearest[n]], point);
                x[n] = direction.x;
                y[n] = direction.y;
                z[n] = direction.z;
            }
            kernels.pack({x.data(), y.data(), z.data(), codes.data(), kBrickPoints});
        }
        const ivec3 end = glm::min(first + ivec3(kEdge), points);
        for (int pz = first.z; pz < end.z; ++pz) {
            for (int py = first.y; py < end.y; ++py) {
                size_t at =
                    (static_cast<size_t>(pz) * static_cast<size_t>(points.y) + static_cast<size_t>(py)) * static_cast<size_t>(points.x) +
                    static_cast<size_t>(first.x);
                auto n = static_cast<size_t>(((pz - first.z) * kEdge + (py - first.y)) * kEdge);
                for (int px = first.x; px < end.x; ++px, ++at, ++n) store(at, squares[n], nearest[n], codes[n], work.listed);
            }
        }
    }

    void store(size_t at, double squared, uint32_t place, uint32_t code, const std::vector<uint32_t>& listed) const {
        const bool none = place == kNoTarget;
        const uint32_t k = none || listed.empty() ? place : listed[place];
        out.distance[at] = none ? metres : std::min(static_cast<float>(std::sqrt(squared)) * voxel, metres);
        out.normal[at] = none ? 0 : (code | (surfaces.empty() ? 0U : uint32_t{surfaces[triangles.owner(k)]} << 28U));
        if (!out.nearest.empty()) out.nearest[at] = none || numbers.empty() ? k : numbers[k];
    }
};

}  // namespace

DistanceBand::DistanceBand(const VoxelGrid& grid, float band, Isa isa)
    : points_(grid.size + ivec3(1)), bricks_((points_ + ivec3(kBrick - 1)) / kBrick), voxel_(grid.voxel), band_(band), isa_(isa) {}

void DistanceBand::reach(const dvec3& low, const dvec3& high, ivec3& first, ivec3& last) const {
    const double width = static_cast<double>(band_) / static_cast<double>(voxel_) + 1e-6;
    for (int k = 0; k < 3; ++k) {
        first[k] = static_cast<int>(std::max(0.0, std::floor((low[k] - width - (kBrick - 1)) / kBrick)));
        last[k] = static_cast<int>(std::min(bricks_[k] - 1.0, std::floor((high[k] + width) / kBrick)));
    }
}

void DistanceBand::markReach(const GridTriangle& triangle, std::span<uint8_t> flags) const {
    const double width = static_cast<double>(band_) / static_cast<double>(voxel_);
    const Reach reach = reachOf(*this, triangle);
    const Target target = targetOf(triangle, width, furthest());
    std::vector<uint32_t> bits;
    for (int z = reach.first[2]; z <= reach.last[2]; ++z)
        forReached(kernelsOf(isa_), width, reach, target.disc, z, bits, [&](const ivec3& b) { flags[brickIndex(b)] = 1; });
}

void DistanceBand::bake(const GridTriangles& triangles, std::span<const uint8_t> surfaces, std::span<const uint32_t> numbers,
                        std::span<const uint8_t> flags, std::span<uint8_t> reached, const BandPoints& out) const {
    const double width = static_cast<double>(band_) / static_cast<double>(voxel_);
    Bake{*this, kernelsOf(isa_), triangles, surfaces, numbers, flags, reached, out, points_,
         width, furthest(),      voxel_,    band_,    {},      {},    {},      {},  {}}
        .run();
}

uint32_t packNormal(const dvec3& direction, uint32_t surface) {
    std::array<double, 8> x, y, z;
    std::array<uint32_t, 8> codes{};
    x.fill(direction.x);
    y.fill(direction.y);
    z.fill(direction == dvec3(0.0) ? 1.0 : direction.z);
    kernelsOf(Isa::generic).pack({x.data(), y.data(), z.data(), codes.data(), 8});
    return codes[0] | surface << 28U;
}

vec3 unpackNormal(uint32_t code) {
    const auto part = [](uint32_t bits) { return (static_cast<float>(bits & 16383U) - 8191.0F) / 8191.0F; };
    const vec2 square(part(code), part(code >> 14U));
    const float z = 1.0F - std::abs(square.x) - std::abs(square.y), fold = std::max(-z, 0.0F);
    return glm::normalize(vec3(square.x - std::copysign(fold, square.x), square.y - std::copysign(fold, square.y), z));
}

}  // namespace rivulet
