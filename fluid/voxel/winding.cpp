#include "fluid/voxel/winding.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <numbers>

#include "engine/core/assert.h"
#include "engine/core/parallel.h"
#include "fluid/voxel/voxelize_surface.h"
#include "fluid/voxel/winding_tree.h"

namespace rivulet {
namespace {

constexpr uint32_t kPiece = 16;   // triangles of a fan treated together
constexpr double kModel = 0.1;    // turns: largest error of the first-order model of all pieces
constexpr double kBend = 0.05;    // turns: its largest error in a cell that is decided voxel by voxel
constexpr int kSmallestCell = 4;  // voxels along the smallest cell that is tested for surface
constexpr int kTask = 16;         // voxels along the cell of one task
constexpr int kEdgeCell = 8;      // voxels along a cell that uses a piece's own edges
constexpr int kSmall = 2;         // voxels along a cell that is decided voxel by voxel

// Calls loop(places) for each closed loop of the directed edges (pairs of places); a loop contains no place twice.
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
            ASSERT(next[here] < end[here], "equally many unmatched edges must begin and end at a place");
            here = target[next[here]++];
            if (at[here] == UINT32_MAX) continue;
            const size_t first = at[here];
            loop(std::span<const uint32_t>(path).subspan(first));
            for (size_t k = first; k < path.size(); ++k) at[path[k]] = UINT32_MAX;
            path.resize(first);
        }
    }
}

// Sets or clears bits [first, end) of the row-major order. Other threads may write adjacent bits at the same time.
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

// The cubes of kSmallestCell, 2 kSmallestCell, 4 kSmallestCell ... voxels that a mesh passes through; touching counts.
class Occupied {
  public:
    Occupied(const CleanMesh& mesh, const VoxelGrid& grid) {
        VoxelGrid bricks;
        bricks.size = (grid.size + kSmallestCell - 1) / kSmallestCell;
        bricks.origin = grid.origin;
        bricks.voxel = grid.voxel * static_cast<float>(kSmallestCell);
        bricks.bits.assign((bricks.count() + 31) / 32 * 4, 0);
        const MeshView view{mesh.positions, mesh.indices, {}, {}};
        voxelizeSurface(GridTriangles(std::span(&view, 1), bricks), bricks);
        levels_.push_back(std::move(bricks));
        while (std::max({levels_.back().size.x, levels_.back().size.y, levels_.back().size.z}) > 1) levels_.push_back(halved());
    }
    // `low` and `size` of a cell; size is a power of two.
    bool test(const ivec3& low, int size) const {
        const int level = size <= kSmallestCell ? 0 : std::countr_zero(static_cast<unsigned>(size / kSmallestCell));
        if (level >= static_cast<int>(levels_.size())) return true;
        return levels_[static_cast<size_t>(level)].test(low / std::max(size, kSmallestCell));
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
    // Triangles that are each one component, by their lowest place.
    std::vector<uint32_t> faces(mesh.defects.components, 0);
    for (uint32_t component : mesh.component) ++faces[component];
    struct Alone {
        uint32_t lowest, face;
    };
    std::vector<Alone> alone;
    for (uint32_t f = 0; f < mesh.source.size(); ++f) {
        const uint32_t* corner = &mesh.indices[3 * size_t{f}];
        if (faces[mesh.component[f]] == 1) alone.push_back({std::min({corner[0], corner[1], corner[2]}), f});
    }
    if (alone.size() < kFew) alone.clear();
    std::sort(alone.begin(), alone.end(),
              [](const Alone& a, const Alone& b) { return a.lowest != b.lowest ? a.lowest < b.lowest : a.face < b.face; });
    std::vector<uint32_t> loose;  // faces
    eachLoop(mesh.unmatched, places.size(), [&](std::span<const uint32_t> loop) {
        if (loop.size() == 3 && !alone.empty()) {
            const uint32_t lowest = std::min({loop[0], loop[1], loop[2]});
            auto at = std::lower_bound(alone.begin(), alone.end(), lowest, [](const Alone& a, uint32_t place) { return a.lowest < place; });
            for (; at != alone.end() && at->lowest == lowest; ++at) {
                const uint32_t* corner = &mesh.indices[3 * size_t{at->face}];
                for (size_t turn = 0; turn < 3; ++turn) {
                    if (corner[0] != loop[turn] || corner[1] != loop[(turn + 1) % 3] || corner[2] != loop[(turn + 2) % 3]) continue;
                    loose.push_back(at->face);
                    return;
                }
            }
        }
        addFan(loop, places);
    });
    if (!loose.empty()) addLoose(mesh, places, loose);
}

// Caps each of these faces of the mesh with its reverse.
void BoundaryCaps::addLoose(const CleanMesh& mesh, std::span<const dvec3> places, std::span<const uint32_t> faces) {
    std::vector<uint8_t> gone(mesh.source.size(), 0);
    for (uint32_t f : faces) {
        const uint32_t* corner = &mesh.indices[3 * size_t{f}];
        Piece piece;
        piece.first = static_cast<uint32_t>(triangles_.size());
        piece.end = piece.first + 1;
        triangles_.push_back({places[corner[1]], places[corner[0]], places[corner[2]]});
        pieces_.push_back(piece);
        gone[f] = 1;
    }
    loose_ = faces.size();
    crossed_.reserve(mesh.indices.size() - 3 * faces.size());
    for (size_t f = 0; f < gone.size(); ++f)
        if (gone[f] == 0) crossed_.insert(crossed_.end(), &mesh.indices[3 * f], &mesh.indices[3 * f] + 3);
}

void BoundaryCaps::addFan(std::span<const uint32_t> loop, std::span<const dvec3> places) {
    dvec3 sum(0.0), low(places[loop[0]]), high(low);
    for (uint32_t place : loop) {
        sum += places[place];
        low = glm::min(low, places[place]);
        high = glm::max(high, places[place]);
    }
    // Slightly off the middle in an arbitrary direction: for a fan in a plane of voxel centres, rounding would decide their side.
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
    // Half a triangle's solid angle is the argument of a complex number: the argument of the product of all is the sum,
    // except for whole turns, which are counted.
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
        const double x = (lengthA * lengthB + glm::dot(a, b)) * lengthC + (alongAC * lengthB + alongBC * lengthA);
        const double turnedRe = re * x - im * y, turnedIm = re * y + im * x;
        turns += im >= 0.0 && y >= 0.0 && turnedIm < 0.0 ? 1 : 0;
        turns -= im < 0.0 && y < 0.0 && turnedIm >= 0.0 ? 1 : 0;
        re = turnedRe;
        im = turnedIm;
        if ((k & 3U) == 3U) {  // prevents overflow and underflow
            const double size = std::abs(re) + std::abs(im), shrink = size > 0.0 ? 1.0 / size : 1.0;
            re *= shrink;
            im *= shrink;
        }
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

// A cube of voxels (the whole grid, then halves), and the model of the pieces there.
struct BoundaryCaps::Cell {
    ivec3 low{0};
    int size = 0;                // a power of two
    std::vector<uint32_t> near;  // pieces, ascending, that are not in the first-order model of the others:
    double far = 0, slack = 0;   // their part at a point p is far + slope . p, with an error of slack
    dvec3 slope{0.0};
    double model(const dvec3& p) const { return far + glm::dot(slope, p); }
};

// Decides cells as a whole where bounds allow it, and halves the others. With r the integer nearest to the caps' part, a voxel is inside
// if and only if its crossings do not sum to r. r is constant where the caps' part stays between two half-integers, which requires a cell
// that no cap passes through. The winding number itself is smooth across caps and decides cells that the mesh does not pass through. The
// smallest cells are decided voxel by voxel.
class BoundaryCaps::Descent {
  public:
    Descent(const BoundaryCaps& caps, const CleanMesh& mesh, const ColumnCrossings& crossings, VoxelGrid& grid)
        : caps_(caps),
          crossings_(crossings),
          grid_(grid),
          occupied_(mesh, grid),
          tolerance_(kModel / static_cast<double>(caps.pieces_.size())) {}

    void run() {
        Cell all;
        all.size = static_cast<int>(std::bit_ceil(static_cast<unsigned>(std::max({grid_.size.x, grid_.size.y, grid_.size.z, kSmall}))));
        for (uint32_t k = 0; k < caps_.pieces_.size(); ++k) all.near.push_back(k);
        descend(all);
    }

  private:
    // A cell's middle, and how far its voxels' centres are from there.
    struct Ball {
        dvec3 middle{0.0};
        double reach = 0;
    };

    // First-order model of the smooth quantity in a cell: the caps' part, or, if a cap passes through, that part minus the crossings.
    struct Smooth {
        double value = 0;  // at the grid's corner
        dvec3 slope{0.0};
        double slack = 0;
        double crossed = 0;  // at the middle
        bool capped = false;
    };

    void descend(const Cell& cell) {
        const ivec3 end = glm::min(cell.low + cell.size, grid_.size);
        if (cell.low.x >= end.x || cell.low.y >= end.y || cell.low.z >= end.z) return;
        const ivec3 middle = glm::min(cell.low + cell.size / 2, end - 1);
        const Ball ball{dvec3(middle) + 0.5, glm::length(dvec3(glm::max(middle - cell.low, end - 1 - middle)))};
        if (partBelowHalf(cell, ball)) return;  // the crossings decide
        Cell inner = cell;
        inner.near.clear();
        double part = 0;
        bool capped = false;
        for (uint32_t k : cell.near) {
            const double value = caps_.winding(caps_.pieces_[k], ball.middle);
            bool passes = false;
            if (moveToModel(caps_.pieces_[k], value, ball, inner, passes)) continue;
            part += value;
            inner.near.push_back(k);
            capped = capped || passes;
        }
        part += inner.model(ball.middle);
        // Over the ball the part is within `change` of the value, and within `bend` of the linear model, except for the caps' steps.
        const Wires wires = outline(inner.near, ball);
        const dvec3 slope = inner.slope + wires.slope / kFullSphere;
        const double bend = inner.slack + 0.5 * ball.reach * ball.reach * wires.bend / kFullSphere + kWindingRounding;
        const double change =
            std::min(inner.slack + ball.reach * (glm::length(inner.slope) + wires.steepest / kFullSphere) + kWindingRounding,
                     ball.reach * glm::length(slope) + bend);
        if (!capped) {
            const double lowest = std::floor(part - change + 0.5), highest = std::floor(part + change + 0.5);
            if (lowest == highest) return compare(cell.low, end, static_cast<int>(lowest));
        }
        const double crossed = crossedAt(middle);
        const bool occupied = occupied_.test(cell.low, cell.size);
        if (std::abs(std::abs(crossed - part) - 0.5) > change && !occupied) return fill(cell.low, end, std::abs(crossed - part) > 0.5);
        const bool smooth = bend < kBend && !(capped && occupied);
        if (cell.size <= kSmall || smooth) {
            const Smooth model{part - glm::dot(slope, ball.middle), slope, smooth ? bend : std::numeric_limits<double>::infinity(), crossed,
                               capped};
            return decideEach(cell.low, end, inner, model);
        }
        inner.size = cell.size / 2;
        const auto half = [&](int k) {
            Cell child = inner;
            child.low = cell.low + inner.size * ivec3(k & 1, (k >> 1) & 1, k >> 2);
            descend(child);
        };
        if (cell.size > kTask)
            parallelFor(0, 8, half);
        else
            for (int k = 0; k < 8; ++k) half(k);
    }

    // A patch's solid angle is at most its area over its least distance squared.
    bool partBelowHalf(const Cell& cell, const Ball& ball) const {
        double most = std::abs(cell.model(ball.middle)) + ball.reach * glm::length(cell.slope) + cell.slack + kWindingRounding;
        for (uint32_t k : cell.near) {
            const Piece& piece = caps_.pieces_[k];
            const double apart = glm::length(piece.centre - ball.middle) - piece.radius - ball.reach;
            if (apart <= 0.0) return false;
            most += piece.area / (kFullSphere * apart * apart);
            if (most >= 0.5) return false;
        }
        return true;
    }

    // Adds a piece whose part at the middle is `value` to the first-order model if its error is small enough all over the ball; else
    // returns whether the piece may pass through the ball.
    bool moveToModel(const Piece& piece, double value, const Ball& ball, Cell& cell, bool& passes) const {
        const double apart = glm::length(piece.centre - ball.middle) - piece.radius - ball.reach, second = 0.5 * ball.reach * ball.reach;
        // By its outline as a wire (Biot and Savart), or by its area as dipoles.
        double wrong = std::numeric_limits<double>::infinity();
        if (apart > 0.0) wrong = second * std::min(2.0 * piece.outline, 6.0 * piece.area / apart) / (kFullSphere * apart * apart * apart);
        if (wrong > tolerance_) {
            passes = apart <= 0.0 && passesThrough(piece, ball);
            if (passes || cell.size > kEdgeCell) return false;
        }
        Wires wires;
        eachWire(piece, [&](const dvec3& a, const dvec3& b) { wires.add(a, b, ball); });
        wrong = std::min(wrong, second * wires.bend / kFullSphere);
        if (wrong > tolerance_) return false;
        const dvec3 slope = wires.slope / kFullSphere;
        cell.far += value - glm::dot(slope, ball.middle);
        cell.slope += slope;
        cell.slack += wrong;
        return true;
    }

    // Currents along edges: their field at the ball's middle is the solid angle's gradient (Biot and Savart).
    struct Wires {
        dvec3 slope{0.0};
        double steepest = 0, bend = 0;  // bounds of the first and the second derivative over the ball
        void add(const dvec3& from, const dvec3& to, const Ball& ball) {
            const dvec3 a = from - ball.middle, b = to - ball.middle;
            const double apart = distanceToSegment(a, b) - ball.reach;
            if (apart <= 0.0) {
                steepest = bend = std::numeric_limits<double>::infinity();
                return;
            }
            const double lengthA = glm::length(a), lengthB = glm::length(b), both = lengthA * lengthB;
            slope += glm::cross(a, b) * ((lengthA + lengthB) / (both * (both + glm::dot(a, b))));
            const double most = std::min(glm::length(to - from) / apart, 2.0) / apart;
            steepest += most;
            bend += 2.0 * most / apart;
        }
    };

    template <class Wire>
    void eachWire(const Piece& piece, Wire wire) const {
        for (uint32_t t = piece.first; t < piece.end; ++t) wire(caps_.triangles_[t][0], caps_.triangles_[t][1]);
        if (piece.next == static_cast<uint32_t>(&piece - caps_.pieces_.data())) return;  // the piece is a whole fan: its ends meet
        wire(caps_.triangles_[piece.first][1], caps_.triangles_[piece.first][2]);
        wire(caps_.triangles_[piece.end - 1][2], caps_.triangles_[piece.end - 1][0]);
    }

    // For several pieces: their outlines cancel where they meet.
    Wires outline(const std::vector<uint32_t>& near, const Ball& ball) const {
        Wires wires;
        for (uint32_t k : near) {
            const Piece& piece = caps_.pieces_[k];
            for (uint32_t t = piece.first; t < piece.end; ++t) wires.add(caps_.triangles_[t][0], caps_.triangles_[t][1], ball);
            const Corners &first = caps_.triangles_[piece.first], &last = caps_.triangles_[piece.end - 1];
            if (!std::binary_search(near.begin(), near.end(), piece.previous)) wires.add(first[1], first[2], ball);
            if (!std::binary_search(near.begin(), near.end(), piece.next)) wires.add(last[2], last[0], ball);
            if (wires.steepest == std::numeric_limits<double>::infinity()) break;
        }
        return wires;
    }

    // If false, certain.
    bool passesThrough(const Piece& piece, const Ball& ball) const {
        for (uint32_t k = piece.first; k < piece.end; ++k) {
            const Corners& t = caps_.triangles_[k];
            const dvec3 a = t[0] - ball.middle, b = t[1] - ball.middle, c = t[2] - ball.middle;
            const dvec3 low = glm::min(a, glm::min(b, c)), high = glm::max(a, glm::max(b, c));
            if (std::max({low.x, low.y, low.z, -high.x, -high.y, -high.z}) > ball.reach) continue;
            const dvec3 normal = glm::cross(b - a, c - a);
            if (std::abs(glm::dot(normal, a)) <= (ball.reach + kWindingRounding) * glm::length(normal)) return true;
        }
        return false;
    }

    // By the smooth model; if that is undecided, by the near pieces; if these are undecided, by all pieces.
    void decideEach(const ivec3& low, const ivec3& end, const Cell& cell, const Smooth& smooth) {
        for (int z = low.z; z < end.z; ++z) {
            for (int y = low.y; y < end.y; ++y) {
                for (int x = low.x; x < end.x; ++x) {
                    const dvec3 p = dvec3(x, y, z) + 0.5;
                    const double crossed = crossedAt({x, y, z});
                    double turns = (smooth.capped ? smooth.crossed : crossed) - smooth.value - glm::dot(smooth.slope, p);
                    if (unclear(turns, smooth.slack)) {
                        turns = crossed - cell.model(p);
                        for (uint32_t k : cell.near) turns -= caps_.winding(caps_.pieces_[k], p);
                        if (unclear(turns, cell.slack + kWindingRounding)) turns = crossed - caps_.winding(p);
                    }
                    assignRun(grid_, grid_.index({x, y, z}), grid_.index({x, y, z}) + 1, std::abs(turns) > 0.5);
                }
            }
        }
    }
    static bool unclear(double turns, double slack) { return std::abs(std::abs(turns) - 0.5) <= slack; }

    size_t columnOf(int y, int z) const { return static_cast<size_t>(z) * static_cast<size_t>(grid_.size.y) + static_cast<size_t>(y); }

    int crossedAt(const ivec3& c) const {
        int winding = 0;
        for (uint32_t crossing : crossings_.column(columnOf(c.y, c.z))) {
            if (crossedVoxel(crossing) > c.x) break;
            winding += crossedChange(crossing);
        }
        return winding;
    }

    void fill(const ivec3& low, const ivec3& end, bool value) {
        for (int z = low.z; z < end.z; ++z)
            for (int y = low.y; y < end.y; ++y)
                assignRun(grid_, grid_.index({low.x, y, z}), grid_.index({low.x, y, z}) + across(low, end), value);
    }

    // Sets the voxels whose crossings do not sum to `nearest`, and clears the others.
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

bool BoundaryCaps::correct(const CleanMesh& mesh, const ColumnCrossings& crossings, VoxelGrid& grid,
                           const std::function<bool(double)>& goOn) const {
    if (pieces_.empty()) return true;
    if (pieces_.size() < kFew) {
        Descent(*this, mesh, crossings, grid).run();
        return true;
    }
    std::vector<uint32_t> ends;
    ends.reserve(pieces_.size());
    for (const Piece& piece : pieces_) ends.push_back(piece.end);
    return WindingTree(triangles_, ends).correct(crossings, grid, goOn);
}

}  // namespace rivulet
