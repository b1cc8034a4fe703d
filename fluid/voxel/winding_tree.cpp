// A field of dipoles n(y) over patches is, at p with R = p - centre and y = centre + s, the sum over k of (-1)^k / k! times the k-th moment
// of n in s with the derivatives of 1 / |R|. The k-th term of a Taylor series in s and in the offset within a ball together is at most (k +
// 1) t^k A / (4 pi R^2), A the area and t the sum of both radii over R: this bounds the remainder.
#include "fluid/voxel/winding_tree.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <numbers>
#include <thread>

#include "engine/core/parallel.h"

namespace rivulet {
namespace {

constexpr uint32_t kLeaf = 8;  // patches
constexpr int kPatchCell = 8;  // voxels along a cell that uses single patches
constexpr int kLast = 4;       // voxels along a cell that is decided, or halved once more where many patches are near
constexpr size_t kCrowd = 12;  // patches that count as many

// Half the solid angle is the argument of this complex number.
struct Turned {
    double y, x;
};
Turned halfAngle(const Corners& t, const dvec3& p) {
    const dvec3 a = t[0] - p, b = t[1] - p, c = t[2] - p;
    const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
    return {glm::dot(a, glm::cross(b, c)), (la * lb + glm::dot(a, b)) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb};
}

// Bound of the terms above the second order, relative to area / (4 pi R^2).
double beyondSecond(double t) { return t * t * t * (4.0 - 3.0 * t) / ((1.0 - t) * (1.0 - t)); }

// The field of a current from a to b at the origin is the gradient of a solid angle (Biot and Savart); also the gradient's derivative.
void addWire(const dvec3& a, const dvec3& b, dvec3& slope, dmat3& bend) {
    const double la = glm::length(a), lb = glm::length(b);
    const double g = 1.0 / la + 1.0 / lb, h = la * lb + glm::dot(a, b), f = g / h;
    const dvec3 c = glm::cross(a, b), ab = a - b;
    const dvec3 ofG = a / (la * la * la) + b / (lb * lb * lb), ofH = -(a * (lb / la) + b * (la / lb) + a + b);
    const dvec3 ofF = (ofG - f * ofH) / h;
    slope += f * c;
    bend += glm::outerProduct(c, ofF);
    bend += f * dmat3(dvec3(0.0, -ab.z, ab.y), dvec3(ab.z, 0.0, -ab.x), dvec3(-ab.y, ab.x, 0.0));
}

}  // namespace

WindingTree::WindingTree(std::span<const Corners> triangles, std::span<const uint32_t> ends)
    : triangles_(triangles), patches_(ends.size()) {
    for (size_t k = 0; k < patches_.size(); ++k) {
        Patch& patch = patches_[k];
        patch.first = k == 0 ? 0 : ends[k - 1];
        patch.end = ends[k];
        dvec3 low(std::numeric_limits<double>::infinity()), high(-low);
        for (uint32_t t = patch.first; t < patch.end; ++t) {
            const Corners& c = triangles_[t];
            low = glm::min(low, glm::min(c[0], glm::min(c[1], c[2])));
            high = glm::max(high, glm::max(c[0], glm::max(c[1], c[2])));
            patch.area += 0.5 * glm::length(glm::cross(c[1] - c[0], c[2] - c[0]));
        }
        patch.centre = 0.5 * (low + high);
        for (uint32_t t = patch.first; t < patch.end; ++t)
            for (const dvec3& corner : triangles_[t]) patch.radius = std::max(patch.radius, glm::length(corner - patch.centre));
    }
    nodes_.reserve(patches_.size() / 2 + 1);
    nodes_.emplace_back();
    build(0, 0, static_cast<uint32_t>(patches_.size()));
    parallelFor(size_t{0}, nodes_.size(), [&](size_t k) { measure(nodes_[k]); });
}

void WindingTree::build(uint32_t node, uint32_t first, uint32_t end) {
    nodes_[node].first = first;
    nodes_[node].end = end;
    dvec3 low(std::numeric_limits<double>::infinity()), high(-low);
    for (uint32_t k = first; k < end; ++k) {
        low = glm::min(low, patches_[k].centre);
        high = glm::max(high, patches_[k].centre);
    }
    nodes_[node].centre = 0.5 * (low + high);
    if (end - first <= kLeaf) return;
    const dvec3 size = high - low;
    const int axis = size.x >= std::max(size.y, size.z) ? 0 : (size.y >= size.z ? 1 : 2);
    const uint32_t middle = first + (end - first) / 2;
    std::nth_element(patches_.begin() + first, patches_.begin() + middle, patches_.begin() + end, [&](const Patch& a, const Patch& b) {
        return a.centre[axis] != b.centre[axis] ? a.centre[axis] < b.centre[axis] : a.first < b.first;
    });
    const auto children = static_cast<uint32_t>(nodes_.size());
    nodes_[node].children = children;
    nodes_.resize(nodes_.size() + 2);
    build(children, first, middle);
    build(children + 1, middle, end);
}

void WindingTree::measure(Node& node) const {
    dmat3 second(0.0);
    for (uint32_t k = node.first; k < node.end; ++k) {
        const Patch& patch = patches_[k];
        node.area += patch.area;
        node.radius = std::max(node.radius, glm::length(patch.centre - node.centre) + patch.radius);
        for (uint32_t t = patch.first; t < patch.end; ++t) {
            const Corners& c = triangles_[t];
            const dvec3 a = c[0] - node.centre, b = c[1] - node.centre, d = c[2] - node.centre, sum = a + b + d;
            const dvec3 n = 0.5 * glm::cross(b - a, d - a);
            node.dipole += n;
            second += glm::outerProduct(n, sum / 3.0);
            // The mean of s s over the triangle.
            const dmat3 m =
                (glm::outerProduct(a, a) + glm::outerProduct(b, b) + glm::outerProduct(d, d) + glm::outerProduct(sum, sum)) / 12.0;
            node.pull += 2.0 * (m * n) + n * (m[0][0] + m[1][1] + m[2][2]);
            std::array<double, 10>& o = node.third;
            o[0] += n.x * m[0][0];
            o[1] += n.y * m[1][1];
            o[2] += n.z * m[2][2];
            o[3] += n.y * m[0][0] + 2.0 * n.x * m[0][1];  // x x y
            o[4] += n.z * m[0][0] + 2.0 * n.x * m[0][2];  // x x z
            o[5] += n.x * m[1][1] + 2.0 * n.y * m[0][1];  // y y x
            o[6] += n.z * m[1][1] + 2.0 * n.y * m[1][2];  // y y z
            o[7] += n.x * m[2][2] + 2.0 * n.z * m[0][2];  // z z x
            o[8] += n.y * m[2][2] + 2.0 * n.z * m[1][2];  // z z y
            o[9] += 2.0 * (n.x * m[1][2] + n.y * m[0][2] + n.z * m[0][1]);
        }
    }
    node.second = 0.5 * (second + glm::transpose(second));
}

double WindingTree::winding(const Patch& patch, const dvec3& p) const {
    double sum = 0;
    for (uint32_t t = patch.first; t < patch.end; ++t) {
        const Turned turned = halfAngle(triangles_[t], p);
        // Most are far and small: series of the arctangent, relative error 2e-11.
        const double r = turned.x > 0.0 ? turned.y / turned.x : 1.0, q = r * r;
        sum += q < 1e-2 ? r * (1.0 - q * (1.0 / 3.0 - q * (0.2 - q * (1.0 / 7.0 - q / 9.0)))) : std::atan2(turned.y, turned.x);
    }
    return sum / (2.0 * std::numbers::pi);
}

double WindingTree::winding(const dvec3& p) const {
    double sum = 0;
    for (const Patch& patch : patches_) sum += winding(patch, p);
    return sum;
}

struct WindingTree::Cell {
    ivec3 low{0};
    int size = 0;                          // a power of two
    LocalField far;                        // about the middle
    std::vector<uint32_t> nodes, patches;  // that are not in the model
    dvec3 middle() const { return dvec3(low) + 0.5 * size; }
    double reach() const { return 0.5 * std::sqrt(3.0) * (size - 1); }
};

class WindingTree::Descent {
  public:
    Descent(const WindingTree& tree, const ColumnCrossings& crossings, VoxelGrid& grid, const std::function<bool(double)>& goOn)
        : tree_(tree),
          crossings_(crossings),
          grid_(grid),
          goOn_(goOn),
          caller_(std::this_thread::get_id()),
          tolerance_(tree.patches_.size() <= kExact ? 0.25 / static_cast<double>(tree.patches_.size())
                                                    : kTolerance / std::sqrt(static_cast<double>(tree.patches_.size()))) {}

    bool run() {
        Cell all;
        all.size = static_cast<int>(std::bit_ceil(static_cast<unsigned>(std::max({grid_.size.x, grid_.size.y, grid_.size.z, kLast}))));
        all.nodes.push_back(0);
        descend(all);
        return !cancelled_;
    }

  private:
    void descend(const Cell& cell) {
        const ivec3 end = glm::min(cell.low + cell.size, grid_.size);
        if (cell.low.x >= end.x || cell.low.y >= end.y || cell.low.z >= end.z || cancelled_) return;
        if (belowHalf(cell)) return tell(cell.low, end);
        Cell inner{cell.low, cell.size, cell.far, {}, {}};
        for (uint32_t node : cell.nodes) sortNode(node, inner);
        std::vector<uint32_t> single;
        single.swap(inner.patches);
        single.insert(single.end(), cell.patches.begin(), cell.patches.end());
        for (uint32_t patch : single)
            if (cell.size > kPatchCell || !moveToModel(tree_.patches_[patch], inner)) inner.patches.push_back(patch);
        const bool last = cell.size == kLast && inner.patches.size() < kCrowd;
        if (last || cell.size < kLast || (inner.nodes.empty() && inner.patches.empty())) {
            decideEach(inner, end);
            return tell(cell.low, end);
        }
        const auto half = [&](int k) {
            const int size = cell.size / 2;
            Cell child{cell.low + size * ivec3(k & 1, (k >> 1) & 1, k >> 2), size, {}, {}, {}};
            child.far = inner.far.moved(child.middle() - inner.middle());
            child.nodes = inner.nodes;
            child.patches = inner.patches;
            descend(child);
        };
        if (cell.size > kPatchCell)
            parallelFor(0, 8, half);
        else
            for (int k = 0; k < 8; ++k) half(k);
    }

    // The part of a patch is at most its area over its least distance squared.
    bool belowHalf(const Cell& cell) const {
        const double reach = cell.reach();
        double most = std::abs(cell.far.value) + reach * glm::length(cell.far.slope) + cell.far.slack + kWindingRounding;
        for (int k = 0; k < 3; ++k) most += 0.5 * reach * reach * glm::length(cell.far.bend[k]);
        const auto add = [&](const auto& some) {
            const double apart = glm::length(some.centre - cell.middle()) - some.radius - reach;
            most += apart > 0.0 ? some.area / (kFullSphere * apart * apart) : 1.0;
            return most < 0.5;
        };
        return most < 0.5 && std::all_of(cell.nodes.begin(), cell.nodes.end(), [&](uint32_t k) { return add(tree_.nodes_[k]); }) &&
               std::all_of(cell.patches.begin(), cell.patches.end(), [&](uint32_t k) { return add(tree_.patches_[k]); });
    }

    // A node is added to the model, replaced by its children, or left for smaller cells.
    void sortNode(uint32_t number, Cell& cell) const {
        const Node& node = tree_.nodes_[number];
        const double reach = cell.reach();
        const dvec3 way = cell.middle() - node.centre;
        const double apart = glm::length(way), share = (node.radius + reach) / apart;
        if (share < 0.8) {
            const double wrong = node.area / (kFullSphere * apart * apart) * beyondSecond(share);
            if (wrong <= tolerance_ * (node.end - node.first)) {
                addNode(node, way, cell.far);
                cell.far.slack += wrong;
                return;
            }
        }
        if (cell.size > kPatchCell && node.radius < reach) {
            cell.nodes.push_back(number);
        } else if (node.children != 0) {
            sortNode(node.children, cell);
            sortNode(node.children + 1, cell);
        } else {
            for (uint32_t k = node.first; k < node.end; ++k) cell.patches.push_back(k);
        }
    }

    static void addNode(const Node& node, const dvec3& r, LocalField& field) {
        const double i2 = 1.0 / glm::dot(r, r), i1 = std::sqrt(i2), i3 = i1 * i2, i5 = i3 * i2, i7 = i5 * i2;
        const double along = glm::dot(node.dipole, r);
        const dvec3 pulled = node.second * r;
        const double q = glm::dot(r, pulled), trace = node.second[0][0] + node.second[1][1] + node.second[2][2];
        const std::array<double, 10>& o = node.third;
        const double cubic = r.x * r.x * (o[0] * r.x + o[3] * r.y + o[4] * r.z) + r.y * r.y * (o[1] * r.y + o[5] * r.x + o[6] * r.z) +
                             r.z * r.z * (o[2] * r.z + o[7] * r.x + o[8] * r.y) + o[9] * r.x * r.y * r.z;
        const double value = -along * i3 - (3.0 * q * i5 - trace * i3) + 0.5 * (-15.0 * cubic * i7 + 3.0 * glm::dot(node.pull, r) * i5);
        const dvec3 slope = (3.0 * along * i5) * r - i3 * node.dipole + (15.0 * q * i7) * r - (3.0 * i5) * (trace * r + 2.0 * pulled);
        const dmat3 cross = glm::outerProduct(node.dipole, r);
        field.value += value / kFullSphere;
        field.slope += slope / kFullSphere;
        field.bend += ((-15.0 * along * i7) * glm::outerProduct(r, r) + (3.0 * i5) * (cross + glm::transpose(cross) + along * dmat3(1.0))) /
                      kFullSphere;
    }

    // By its outline, the sum of the outlines of its triangles.
    bool moveToModel(const Patch& patch, Cell& cell) const {
        const dvec3 middle = cell.middle();
        const double reach = cell.reach(), away = glm::length(patch.centre - middle);
        if (patch.radius + reach < 0.8 * away) {
            const double wrong = patch.area / (kFullSphere * away * away) * beyondSecond((patch.radius + reach) / away);
            if (wrong <= tolerance_) return addPatch(patch, middle, wrong, cell.far);
        }
        double wrong = 0;
        for (uint32_t t = patch.first; t < patch.end; ++t) {
            const Corners& c = tree_.triangles_[t];
            for (size_t k = 0; k < 3; ++k) {
                const dvec3 a = c[k] - middle, b = c[(k + 1) % 3] - middle;
                const double apart = distanceToSegment(a, b) - reach;
                if (apart <= 0.0) return false;
                const double share = reach / apart;
                wrong += std::min(glm::length(b - a) / apart, 0.5 * std::numbers::pi) * share * share * share / kFullSphere;
                if (wrong > tolerance_) return false;
            }
            // The outlines are all beyond the ball; the triangle may still pass through it.
            const dvec3 normal = glm::cross(c[1] - c[0], c[2] - c[0]);
            if (std::abs(glm::dot(normal, c[0] - middle)) > (reach + kWindingRounding) * glm::length(normal)) continue;
            const dvec3 foot = middle + normal * (glm::dot(normal, c[0] - middle) / std::max(glm::dot(normal, normal), 1e-300));
            bool within = true;
            for (size_t k = 0; k < 3; ++k) within = within && glm::dot(glm::cross(c[(k + 1) % 3] - c[k], foot - c[k]), normal) >= 0.0;
            if (within) return false;
        }
        return addPatch(patch, middle, wrong, cell.far);
    }
    bool addPatch(const Patch& patch, const dvec3& middle, double wrong, LocalField& field) const {
        dvec3 slope(0.0);
        dmat3 bend(0.0);
        for (uint32_t t = patch.first; t < patch.end; ++t)
            for (size_t k = 0; k < 3; ++k) addWire(tree_.triangles_[t][k] - middle, tree_.triangles_[t][(k + 1) % 3] - middle, slope, bend);
        field.value += tree_.winding(patch, middle);
        field.slope += slope / kFullSphere;
        field.bend += bend / kFullSphere;
        field.slack += wrong;
        return true;
    }

    void decideEach(const Cell& cell, const ivec3& end) {
        const bool exact = tree_.patches_.size() <= kExact;
        for (int z = cell.low.z; z < end.z; ++z) {
            for (int y = cell.low.y; y < end.y; ++y) {
                const std::span<const uint32_t> column =
                    crossings_.column(static_cast<size_t>(z) * static_cast<size_t>(grid_.size.y) + static_cast<size_t>(y));
                size_t next = 0;
                int crossed = 0;
                for (int x = cell.low.x; x < end.x; ++x) {
                    for (; next < column.size() && crossedVoxel(column[next]) <= x; ++next) crossed += crossedChange(column[next]);
                    const dvec3 p = dvec3(x, y, z) + 0.5;
                    double turns = crossed - cell.far.at(p - cell.middle());
                    for (uint32_t k : cell.patches) turns -= tree_.winding(tree_.patches_[k], p);
                    if (exact && std::abs(std::abs(turns) - 0.5) <= cell.far.slack + kWindingRounding) turns = crossed - tree_.winding(p);
                    assign(grid_.index({x, y, z}), std::abs(turns) > 0.5);
                }
            }
        }
    }
    // Other threads may write adjacent bits at the same time.
    void assign(size_t voxel, bool value) {
        const auto mask = static_cast<uint8_t>(1U << (voxel & 7U));
        std::atomic_ref<uint8_t> bits(grid_.bits[voxel >> 3U]);
        if (((bits.load(std::memory_order_relaxed) & mask) != 0) == value) return;
        if (value)
            bits.fetch_or(mask, std::memory_order_relaxed);
        else
            bits.fetch_and(static_cast<uint8_t>(~mask), std::memory_order_relaxed);
    }

    // Voxels low to end are finished.
    void tell(const ivec3& low, const ivec3& end) {
        const ivec3 size = end - low;
        const size_t done = done_ += static_cast<size_t>(size.x) * static_cast<size_t>(size.y) * static_cast<size_t>(size.z);
        if (!goOn_ || std::this_thread::get_id() != caller_) return;
        const double share = static_cast<double>(done) / static_cast<double>(grid_.count());
        if (share < told_ + 0.005) return;
        told_ = share;
        if (!goOn_(share)) cancelled_ = true;
    }

    const WindingTree& tree_;
    const ColumnCrossings& crossings_;
    VoxelGrid& grid_;
    const std::function<bool(double)>& goOn_;
    const std::thread::id caller_;
    double tolerance_;  // of one patch
    double told_ = 0;   // on the calling thread alone
    std::atomic<size_t> done_ = 0;
    std::atomic<bool> cancelled_ = false;
};

bool WindingTree::correct(const ColumnCrossings& crossings, VoxelGrid& grid, const std::function<bool(double)>& goOn) const {
    return Descent(*this, crossings, grid, goOn).run();
}

}  // namespace rivulet
