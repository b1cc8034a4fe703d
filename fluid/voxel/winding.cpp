#include "fluid/voxel/winding.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <numbers>

#include "engine/core/assert.h"
#include "fluid/voxel/voxelize_surface.h"

namespace rivulet {
namespace {

constexpr uint32_t kPiece = 16;     // triangles of a fan looked at together
constexpr double kFrozen = 0.15;    // turns that all pieces taken as constant over a cell may be wrong by
constexpr double kRounding = 1e-9;  // turns
constexpr int kBrick = 4;           // voxels along the smallest cell that is asked for surface
constexpr int kTask = 16;           // voxels along a cell that is one task

double distanceToSegment(const dvec3& p, const dvec3& a, const dvec3& b) {
    const dvec3 ab = b - a;
    const double along = glm::dot(p - a, ab), all = glm::dot(ab, ab);
    return glm::length(p - (a + ab * (all > 0.0 ? std::clamp(along / all, 0.0, 1.0) : 0.0)));
}

// Closed loops that the directed edges (pairs of places) form; no place twice in one. loop(places) for each.
template <class Loop>
void eachLoop(std::span<const uint32_t> edges, size_t places, Loop loop) {
    std::vector<uint32_t> next(places + 1, 0), target(edges.size() / 2);
    for (size_t k = 0; k < edges.size(); k += 2) ++next[edges[k] + 1];
    for (size_t k = 1; k <= places; ++k) next[k] += next[k - 1];
    std::vector<uint32_t> end(next.begin() + 1, next.end()), fill(next.begin(), next.end() - 1);
    for (size_t k = 0; k < edges.size(); k += 2) target[fill[edges[k]]++] = edges[k + 1];
    std::vector<uint32_t> path, at(places, UINT32_MAX);  // at: a place's position on the path
    for (uint32_t start = 0; start < places; ++start) {
        uint32_t here = start;
        while (next[here] < end[here] || !path.empty()) {
            at[here] = static_cast<uint32_t>(path.size());
            path.push_back(here);
            ASSERT(next[here] < end[here], "as many unmatched edges end at a place as begin there");
            here = target[next[here]++];
            if (at[here] == UINT32_MAX) continue;
            const size_t first = at[here];
            loop(std::span<const uint32_t>(path).subspan(first));
            for (size_t k = first; k < path.size(); ++k) at[path[k]] = UINT32_MAX;
            path.resize(first);
        }
    }
}

// Sets or clears bits [first, end) of the row-major order. Other threads may be at their neighbours.
void assignRun(VoxelGrid& grid, size_t first, size_t end, bool value) {
    for (size_t byte = first >> 3U; first < end && byte <= (end - 1) >> 3U; ++byte) {
        unsigned mask = 0xFFU;
        if (byte == first >> 3U) mask &= 0xFFU << (first & 7U);
        if (byte == (end - 1) >> 3U) mask &= 0xFFU >> (7U - ((end - 1) & 7U));
        std::atomic_ref<uint8_t> bits(grid.bits[byte]);
        if (value)
            bits.fetch_or(static_cast<uint8_t>(mask), std::memory_order_relaxed);
        else
            bits.fetch_and(static_cast<uint8_t>(~mask), std::memory_order_relaxed);
    }
}

// Which cubes of kBrick, 2 kBrick, 4 kBrick ... voxels a mesh passes through; touching counts.
class Occupied {
  public:
    Occupied(const CleanMesh& mesh, const VoxelGrid& grid) {
        VoxelGrid bricks;
        bricks.size = (grid.size + kBrick - 1) / kBrick;
        bricks.origin = grid.origin;
        bricks.voxel = grid.voxel * static_cast<float>(kBrick);
        bricks.bits.assign((bricks.count() + 31) / 32 * 4, 0);
        const MeshView view{mesh.positions, mesh.indices, {}, {}};
        voxelizeSurface(GridTriangles(std::span(&view, 1), bricks), bricks);
        levels_.push_back(std::move(bricks));
        while (std::max({levels_.back().size.x, levels_.back().size.y, levels_.back().size.z}) > 1) levels_.push_back(halved());
    }
    // `low` and `size` of a cell; size is a power of two.
    bool test(const ivec3& low, int size) const {
        const int level = size <= kBrick ? 0 : std::countr_zero(static_cast<unsigned>(size / kBrick));
        if (level >= static_cast<int>(levels_.size())) return true;
        return levels_[static_cast<size_t>(level)].test(low / std::max(size, kBrick));
    }

  private:
    VoxelGrid halved() const {
        const VoxelGrid& fine = levels_.back();
        VoxelGrid coarse;
        coarse.size = (fine.size + 1) / 2;
        coarse.bits.assign((coarse.count() + 31) / 32 * 4, 0);
        for (int z = 0; z < fine.size.z; ++z)
            for (int y = 0; y < fine.size.y; ++y)
                for (int x = 0; x < fine.size.x; ++x)
                    if (fine.test({x, y, z})) coarse.set({x / 2, y / 2, z / 2});
        return coarse;
    }
    std::vector<VoxelGrid> levels_;
};

}  // namespace

BoundaryCaps::BoundaryCaps(const CleanMesh& mesh, std::span<const dvec3> places) {
    eachLoop(mesh.unmatched, places.size(), [&](std::span<const uint32_t> loop) { addFan(loop, places); });
}

void BoundaryCaps::addFan(std::span<const uint32_t> loop, std::span<const dvec3> places) {
    dvec3 sum(0.0), low(places[loop[0]]), high(low);
    for (uint32_t place : loop) {
        sum += places[place];
        low = glm::min(low, places[place]);
        high = glm::max(high, places[place]);
    }
    // Off the middle by a little in no special direction: a fan in the plane of voxel centres would leave their side of it to rounding.
    const dvec3 tip = sum / static_cast<double>(loop.size()) + glm::length(high - low) * dvec3(3.1e-5, -4.7e-5, 5.9e-5);
    const auto ringFirst = static_cast<uint32_t>(pieces_.size());
    for (size_t first = 0; first < loop.size(); first += kPiece) {
        Piece piece;
        piece.first = static_cast<uint32_t>(triangles_.size());
        dvec3 from(tip), to(tip);
        for (size_t k = first; k < std::min<size_t>(first + kPiece, loop.size()); ++k) {
            const dvec3 &u = places[loop[k]], &v = places[loop[(k + 1) % loop.size()]];
            triangles_.push_back({v, u, tip});
            from = glm::min(from, glm::min(u, v));
            to = glm::max(to, glm::max(u, v));
            piece.area += 0.5 * glm::length(glm::cross(u - tip, v - tip));
            piece.outline += glm::length(v - u);
        }
        piece.end = static_cast<uint32_t>(triangles_.size());
        piece.centre = 0.5 * (from + to);
        piece.radius = 0.5 * glm::length(to - from);
        piece.outline += glm::length(triangles_[piece.first][1] - tip) + glm::length(triangles_.back()[0] - tip);
        piece.previous = static_cast<uint32_t>(pieces_.size()) - 1;
        piece.next = static_cast<uint32_t>(pieces_.size()) + 1;
        pieces_.push_back(piece);
    }
    pieces_[ringFirst].previous = static_cast<uint32_t>(pieces_.size()) - 1;
    pieces_.back().next = ringFirst;
}

double BoundaryCaps::winding(const Piece& piece, const dvec3& p) const {
    // Half a triangle's solid angle is the argument of a complex number: the product of all has the sum as its argument, but for whole
    // turns, which are counted.
    double re = 1, im = 0;
    int turns = 0;
    const dvec3 c = triangles_[piece.first][2] - p;
    dvec3 b = triangles_[piece.first][1] - p;
    const double lengthC = glm::length(c);
    double lengthB = glm::length(b), alongBC = glm::dot(b, c);
    for (uint32_t k = piece.first; k < piece.end; ++k) {
        const dvec3 a = triangles_[k][0] - p;  // the next triangle's b
        const double lengthA = glm::length(a), alongAC = glm::dot(a, c);
        const double y = glm::dot(a, glm::cross(b, c));
        const double x = lengthA * lengthB * lengthC + glm::dot(a, b) * lengthC + alongAC * lengthB + alongBC * lengthA;
        const double turnedRe = re * x - im * y, turnedIm = re * y + im * x;
        if (im >= 0.0 && y >= 0.0 && turnedIm < 0.0) ++turns;
        if (im < 0.0 && y < 0.0 && turnedIm >= 0.0) --turns;
        const double size = std::abs(turnedRe) + std::abs(turnedIm), shrink = size > 0.0 ? 1.0 / size : 1.0;
        re = turnedRe * shrink;
        im = turnedIm * shrink;
        b = a;
        lengthB = lengthA;
        alongBC = alongAC;
    }
    return std::atan2(im, re) / (2.0 * std::numbers::pi) + turns;
}

double BoundaryCaps::winding(const dvec3& p) const {
    double sum = 0;
    for (const Piece& piece : pieces_) sum += winding(piece, p);
    return sum;
}

// A cube of voxels from the whole grid down, and what is known of the pieces there.
struct BoundaryCaps::Cell {
    ivec3 low{0};
    int size = 0;                // a power of two
    std::vector<uint32_t> near;  // pieces whose part varies over the cell, ascending
    double far = 0, slack = 0;   // the others' part, and how much it may be wrong by
};

// Decides cells as a whole where bounds allow it, and halves the others. With r the integer nearest to the caps' part, a voxel is inside
// iff its crossings count to other than r. r is constant where the caps' part stays between two halves, which takes a cell that no cap
// passes through; the winding number itself is smooth across caps, and settles cells that the mesh does not pass through.
class BoundaryCaps::Descent {
  public:
    Descent(const BoundaryCaps& caps, const CleanMesh& mesh, const ColumnCrossings& crossings, VoxelGrid& grid)
        : caps_(caps),
          crossings_(crossings),
          grid_(grid),
          occupied_(mesh, grid),
          tolerance_(kFrozen / static_cast<double>(caps.pieces_.size())) {}

    void run() {
        Cell all;
        all.size = static_cast<int>(std::bit_ceil(static_cast<unsigned>(std::max({grid_.size.x, grid_.size.y, grid_.size.z}))));
        for (uint32_t k = 0; k < caps_.pieces_.size(); ++k) all.near.push_back(k);
        descend(all);
    }

  private:
    void descend(const Cell& cell) {
        const ivec3 end = glm::min(cell.low + cell.size, grid_.size);
        if (cell.low.x >= end.x || cell.low.y >= end.y || cell.low.z >= end.z) return;
        const ivec3 middle = glm::min(cell.low + cell.size / 2, end - 1);
        const dvec3 p = dvec3(middle) + 0.5;
        const double reach = glm::length(dvec3(glm::max(middle - cell.low, end - 1 - middle)));
        if (partBelowHalf(cell, p, reach)) return;  // what the crossings say holds
        Cell inner;
        inner.far = cell.far;
        inner.slack = cell.slack;
        inner.size = cell.size / 2;
        double part = 0;
        bool capped = false;
        for (uint32_t k : cell.near) {
            const Piece& piece = caps_.pieces_[k];
            const double value = caps_.winding(piece, p), apart = glm::length(piece.centre - p) - piece.radius - reach;
            const double change = apart > 0.0 ? reach * steepest(piece, apart) : 1.0;
            if (change <= tolerance_) {
                inner.far += value;
                inner.slack += change;
            } else {
                part += value;
                inner.near.push_back(k);
                capped = capped || apart <= 0.0;
            }
        }
        part += inner.far;
        if (cell.size == 1) return decideVoxel(middle, p, part, inner.slack);
        const double slack = inner.slack + reach * slope(inner.near, p, reach) + kRounding;
        if (!capped) {
            const double lowest = std::floor(part - slack + 0.5), highest = std::floor(part + slack + 0.5);
            if (lowest == highest) return compare(cell.low, end, static_cast<int>(lowest));
        }
        if (!occupied_.test(cell.low, cell.size)) {
            const double turns = std::abs(crossedAt(middle) - part);
            if (std::abs(turns - 0.5) > slack) return fill(cell.low, end, turns > 0.5);
        }
        const auto half = [&](int k) {
            Cell child = inner;
            child.low = cell.low + inner.size * ivec3(k & 1, (k >> 1) & 1, k >> 2);
            descend(child);
        };
        if (cell.size > kTask)
            tbb::parallel_for(0, 8, half);
        else
            for (int k = 0; k < 8; ++k) half(k);
    }

    // A patch's solid angle is at most its area over its least distance squared.
    bool partBelowHalf(const Cell& cell, const dvec3& p, double reach) const {
        double most = std::abs(cell.far) + cell.slack + kRounding;
        for (uint32_t k : cell.near) {
            const Piece& piece = caps_.pieces_[k];
            const double apart = glm::length(piece.centre - p) - piece.radius - reach;
            if (apart <= 0.0) return false;
            most += piece.area / (4.0 * std::numbers::pi * apart * apart);
            if (most >= 0.5) return false;
        }
        return true;
    }

    // The most a piece's part changes per voxel at that distance: by its outline as a wire (Biot and Savart), or by its area as dipoles.
    static double steepest(const Piece& piece, double apart) {
        return std::min(piece.outline, 2.0 * piece.area / apart) / (4.0 * std::numbers::pi * apart * apart);
    }

    // The same for several pieces at once, whose inner outlines cancel.
    double slope(const std::vector<uint32_t>& near, const dvec3& p, double reach) const {
        double sum = 0;
        const auto wire = [&](const dvec3& a, const dvec3& b) {
            const double apart = distanceToSegment(p, a, b) - reach;
            sum += apart > 0.0 ? std::min(glm::length(b - a) / apart, 2.0) / apart : std::numeric_limits<double>::infinity();
        };
        for (uint32_t k : near) {
            const Piece& piece = caps_.pieces_[k];
            for (uint32_t t = piece.first; t < piece.end; ++t) wire(caps_.triangles_[t][0], caps_.triangles_[t][1]);
            const Corners &first = caps_.triangles_[piece.first], &last = caps_.triangles_[piece.end - 1];
            if (!std::binary_search(near.begin(), near.end(), piece.previous)) wire(first[1], first[2]);
            if (!std::binary_search(near.begin(), near.end(), piece.next)) wire(last[0], last[2]);
            if (sum == std::numeric_limits<double>::infinity()) break;
        }
        return sum / (4.0 * std::numbers::pi);
    }

    size_t columnOf(int y, int z) const { return static_cast<size_t>(z) * static_cast<size_t>(grid_.size.y) + static_cast<size_t>(y); }

    int crossedAt(const ivec3& c) const {
        int winding = 0;
        for (uint32_t crossing : crossings_.column(columnOf(c.y, c.z))) {
            if (crossedVoxel(crossing) > c.x) break;
            winding += crossedChange(crossing);
        }
        return winding;
    }

    void decideVoxel(const ivec3& c, const dvec3& p, double part, double slack) {
        const int crossed = crossedAt(c);
        double turns = std::abs(crossed - part);
        if (std::abs(turns - 0.5) <= slack + kRounding) turns = std::abs(crossed - caps_.winding(p));
        assignRun(grid_, grid_.index(c), grid_.index(c) + 1, turns > 0.5);
    }

    void fill(const ivec3& low, const ivec3& end, bool value) {
        for (int z = low.z; z < end.z; ++z)
            for (int y = low.y; y < end.y; ++y)
                assignRun(grid_, grid_.index({low.x, y, z}), grid_.index({low.x, y, z}) + across(low, end), value);
    }

    // Sets what the crossings count to other than `nearest`, and clears the rest.
    void compare(const ivec3& low, const ivec3& end, int nearest) {
        if (nearest == 0) return;
        for (int z = low.z; z < end.z; ++z) {
            for (int y = low.y; y < end.y; ++y) {
                const size_t row = grid_.index({0, y, z});
                int from = low.x, winding = 0;
                for (uint32_t crossing : crossings_.column(columnOf(y, z))) {
                    const int to = std::clamp(crossedVoxel(crossing), from, end.x);
                    assignRun(grid_, row + static_cast<size_t>(from), row + static_cast<size_t>(to), winding != nearest);
                    winding += crossedChange(crossing);
                    from = to;
                }
                assignRun(grid_, row + static_cast<size_t>(from), row + static_cast<size_t>(end.x), winding != nearest);
            }
        }
    }
    static size_t across(const ivec3& low, const ivec3& end) { return static_cast<size_t>(end.x - low.x); }

    const BoundaryCaps& caps_;
    const ColumnCrossings& crossings_;
    VoxelGrid& grid_;
    Occupied occupied_;
    double tolerance_;
};

void BoundaryCaps::correct(const CleanMesh& mesh, const ColumnCrossings& crossings, VoxelGrid& grid) const {
    if (!pieces_.empty()) Descent(*this, mesh, crossings, grid).run();
}

}  // namespace rivulet
