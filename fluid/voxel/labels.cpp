// Finds runs of equal kind along x, 64 voxels at a time; then union-find over runs, one stack of layers per task.
#include "fluid/voxel/labels.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <new>

#include "engine/core/assert.h"
#include "engine/core/parallel.h"

namespace rivulet {
namespace {

constexpr uint32_t kNoRun = std::numeric_limits<uint32_t>::max();
constexpr int kLayers = 16;        // z layers per task
constexpr size_t kRowChunk = 512;  // rows per task; a multiple of 8, so that no two tasks write the same byte of bits

// Kinds of runs, before they have labels.
constexpr uint32_t kOpen = 0, kWithin = 2, kCavity = 3;

// 64 bits from bit `first` on; 0 beyond the end.
uint64_t wordAt(const std::vector<uint8_t>& bits, size_t first) {
    const size_t byte = first >> 3U;
    const unsigned shift = first & 7U;
    uint64_t word = 0;
    if (byte + 9 <= bits.size()) {
        std::memcpy(&word, &bits[byte], 8);
        return shift == 0 ? word : (word >> shift) | (uint64_t{bits[byte + 8]} << (64U - shift));
    }
    for (size_t k = byte; k < std::min(byte + 9, bits.size()); ++k) {
        const auto to = static_cast<int>(8 * (k - byte)) - static_cast<int>(shift);
        word |= to < 0 ? uint64_t{bits[k]} >> shift : to < 64 ? uint64_t{bits[k]} << static_cast<unsigned>(to) : 0;
    }
    return word;
}

// Calls body(x, kind) for each run of a row. Runs start where a word differs from itself shifted by one bit.
template <class Body>
void forRuns(const VoxelGrid& surface, const VoxelGrid* inside, size_t row, const Body& body) {
    const auto width = static_cast<size_t>(surface.size.x);
    uint64_t lastSurface = 0, lastInside = 0;  // the voxel before, in bit 0
    for (size_t x = 0; x < width; x += 64) {
        const uint64_t set = wordAt(surface.bits, row * width + x);
        const uint64_t within = inside != nullptr ? wordAt(inside->bits, row * width + x) & ~set : 0;
        uint64_t starts = (set ^ ((set << 1U) | lastSurface)) | (within ^ ((within << 1U) | lastInside));
        if (x == 0) starts |= 1U;
        if (width - x < 64) starts &= (uint64_t{1} << (width - x)) - 1;
        lastSurface = set >> 63U;
        lastInside = within >> 63U;
        for (; starts != 0; starts &= starts - 1) {
            const auto bit = static_cast<unsigned>(std::countr_zero(starts));
            body(static_cast<uint32_t>(x + bit), ((set >> bit) & 1U) != 0 ? kInsideSurface : ((within >> bit) & 1U) != 0 ? kWithin : kOpen);
        }
    }
}

template <class Body>
void forRowChunks(size_t rows, const Body& body) {
    parallelFor(size_t{0}, (rows + kRowChunk - 1) / kRowChunk,
                [&](size_t chunk) { body(chunk * kRowChunk, std::min(rows, (chunk + 1) * kRowChunk)); });
}

void findRuns(const VoxelGrid& surface, const VoxelGrid* inside, VoxelLabels& labels) {
    const size_t rows = rowsOf(surface.size);
    labels.rowStart.assign(rows + 1, 0);
    forRowChunks(rows, [&](size_t first, size_t end) {
        for (size_t row = first; row < end; ++row) {
            uint32_t count = 0;
            forRuns(surface, inside, row, [&](uint32_t, uint32_t) { ++count; });
            labels.rowStart[row + 1] = count;
        }
    });
    size_t total = 0;
    for (uint32_t& start : labels.rowStart) {
        total += start;
        start = static_cast<uint32_t>(total);
    }
    if (total >= kNoRun) throw std::bad_alloc();
    labels.runs.resize(total);
    forRowChunks(rows, [&](size_t first, size_t end) {
        for (size_t row = first; row < end; ++row) {
            LabelRun* run = labels.runs.data() + labels.rowStart[row];
            forRuns(surface, inside, row, [&](uint32_t x, uint32_t kind) { *run++ = {x, kind}; });
        }
    });
}

// The root of a region is its lowest run, so it does not depend on the order of joins.
class RunJoiner {
  public:
    explicit RunJoiner(const VoxelLabels& labels) : labels_(labels), parent_(labels.runs.size()) {}

    // Layers in stacks side by side, then the stacks' borders.
    std::vector<uint32_t> join() {
        const int depth = labels_.size.z;
        parallelFor(0, (depth + kLayers - 1) / kLayers, [&](int stack) {
            const int first = stack * kLayers, end = std::min(depth, first + kLayers);
            const size_t from = labels_.rowStart[row(0, first)], to = labels_.rowStart[row(0, end)];
            for (size_t k = from; k < to; ++k) parent_[k] = static_cast<uint32_t>(k);
            for (int z = first; z < end; ++z) {
                for (int y = 0; y < labels_.size.y; ++y) {
                    if (y > 0) joinRows(row(y, z), row(y - 1, z));
                    if (z > first) joinRows(row(y, z), row(y, z - 1));
                }
            }
        });
        for (int z = kLayers; z < depth; z += kLayers) {
            for (int y = 0; y < labels_.size.y; ++y) joinRows(row(y, z), row(y, z - 1));
        }
        for (uint32_t& parent : parent_) parent = parent_[parent];  // parents come first
        return std::move(parent_);
    }

  private:
    size_t row(int y, int z) const { return static_cast<size_t>(z) * static_cast<size_t>(labels_.size.y) + static_cast<size_t>(y); }

    uint32_t find(uint32_t run) {
        while (parent_[run] != run) {
            parent_[run] = parent_[parent_[run]];
            run = parent_[run];
        }
        return run;
    }

    void joinRows(size_t one, size_t other) {
        const std::vector<uint32_t>& start = labels_.rowStart;
        const std::vector<LabelRun>& runs = labels_.runs;
        uint32_t a = start[one], b = start[other];
        const uint32_t endA = start[one + 1], endB = start[other + 1];
        while (a < endA && b < endB) {
            if (runs[a].label == runs[b].label && runs[a].label != kInsideSurface) {
                const uint32_t rootA = find(a), rootB = find(b);
                parent_[std::max(rootA, rootB)] = std::min(rootA, rootB);
            }
            const uint32_t nextA = a + 1 < endA ? runs[a + 1].x : kNoRun, nextB = b + 1 < endB ? runs[b + 1].x : kNoRun;
            a += nextA <= nextB ? 1 : 0;
            b += nextB <= nextA ? 1 : 0;
        }
    }

    const VoxelLabels& labels_;
    std::vector<uint32_t> parent_;
};

// body(run, y, z, first x, last x), in order.
template <class Body>
void forAllRuns(const VoxelLabels& labels, const Body& body) {
    size_t row = 0;
    for (int z = 0; z < labels.size.z; ++z) {
        for (int y = 0; y < labels.size.y; ++y, ++row) {
            const uint32_t end = labels.rowStart[row + 1];
            for (uint32_t k = labels.rowStart[row]; k < end; ++k) {
                const int last = k + 1 < end ? static_cast<int>(labels.runs[k + 1].x) - 1 : labels.size.x - 1;
                body(k, y, z, static_cast<int>(labels.runs[k].x), last);
            }
        }
    }
}

// Replaces kinds by labels. `root`: of each run, the first run of its region. `outside`: of each root, whether the region is kOutside.
void numberRegions(VoxelLabels& labels, const std::vector<uint32_t>& root, const std::vector<uint8_t>& outside, float voxel) {
    std::vector<uint32_t> number(labels.runs.size(), kOutside);  // of roots
    forAllRuns(labels, [&](uint32_t k, int y, int z, int first, int last) {
        LabelRun& run = labels.runs[k];
        const auto voxels = static_cast<size_t>(last - first + 1);
        if (run.label == kInsideSurface) {
            labels.surface += voxels;
            return;
        }
        if (outside[root[k]] != 0) {
            labels.outside += voxels;
            run.label = kOutside;
            return;
        }
        if (root[k] == k) {
            number[k] = kFirstMaterial + static_cast<uint32_t>(labels.materials.size());
            labels.materials.push_back({0, 0.0, ivec3(first, y, z), ivec3(last, y, z), run.label != kCavity});
        }
        run.label = number[root[k]];
        VoxelMaterial& material = labels.materials[run.label - kFirstMaterial];
        material.voxels += voxels;
        material.low = glm::min(material.low, ivec3(first, y, z));
        material.high = glm::max(material.high, ivec3(last, y, z));
    });
    const auto edge = static_cast<double>(voxel);
    for (VoxelMaterial& material : labels.materials) material.volume = static_cast<double>(material.voxels) * edge * edge * edge;
}

// Sets bits [first, last]; no other thread writes to their bytes.
void setBits(std::vector<uint8_t>& bits, size_t first, size_t last) {
    const size_t firstByte = first >> 3U, lastByte = last >> 3U;
    const auto head = static_cast<uint8_t>(0xFFU << (first & 7U)), tail = static_cast<uint8_t>(0xFFU >> (7U - (last & 7U)));
    if (firstByte == lastByte) {
        bits[firstByte] = static_cast<uint8_t>(bits[firstByte] | (head & tail));
        return;
    }
    bits[firstByte] = static_cast<uint8_t>(bits[firstByte] | head);
    std::memset(bits.data() + firstByte + 1, 0xFF, lastByte - firstByte - 1);
    bits[lastByte] = static_cast<uint8_t>(bits[lastByte] | tail);
}

// body(first voxel, last voxel, label) of every run, in the grid's order; several rows at once.
template <class Body>
void forVoxels(const VoxelLabels& labels, const Body& body) {
    const auto width = static_cast<size_t>(labels.size.x);
    forRowChunks(rowsOf(labels.size), [&](size_t first, size_t end) {
        for (size_t row = first; row < end; ++row) {
            for (uint32_t k = labels.rowStart[row]; k < labels.rowStart[row + 1]; ++k) {
                const size_t stop = k + 1 < labels.rowStart[row + 1] ? labels.runs[k + 1].x : width;
                body(row * width + labels.runs[k].x, row * width + stop - 1, labels.runs[k].label);
            }
        }
    });
}

}  // namespace

// Hues a golden angle apart in OKLab (Ottosson 2020), lightness 0.75, chroma 0.11: the largest chroma that every hue can have.
vec3 materialColour(uint32_t index) {
    const double turn = 0.61803398874989485 * static_cast<double>(index) + 0.08;
    const double hue = 6.283185307179586 * (turn - std::floor(turn));
    const double a = 0.11 * std::cos(hue), b = 0.11 * std::sin(hue);
    const auto cube = [](double v) { return v * v * v; };
    const double l = cube(0.75 + 0.3963377774 * a + 0.2158037573 * b), m = cube(0.75 - 0.1055613458 * a - 0.0638541728 * b),
                 s = cube(0.75 - 0.0894841775 * a - 1.2914855480 * b);
    const dvec3 linear(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s, -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
                       -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s);
    return vec3(glm::clamp(linear, 0.0, 1.0));
}

uint32_t VoxelLabels::at(const ivec3& c) const {
    if (c.x < 0 || c.y < 0 || c.z < 0 || c.x >= size.x || c.y >= size.y || c.z >= size.z) return kOutside;
    const std::span<const LabelRun> of = row(c.y, c.z);
    const auto after =
        std::upper_bound(of.begin(), of.end(), static_cast<uint32_t>(c.x), [](uint32_t x, const LabelRun& run) { return x < run.x; });
    return std::prev(after)->label;
}

std::span<const LabelRun> VoxelLabels::row(int y, int z) const {
    const size_t k = static_cast<size_t>(z) * static_cast<size_t>(size.y) + static_cast<size_t>(y);
    return {runs.data() + rowStart[k], rowStart[k + 1] - rowStart[k]};
}

VoxelLabels labelRegions(const VoxelGrid& surface, const VoxelGrid* inside) {
    ASSERT(inside == nullptr || inside->size == surface.size, "`inside` must have the size of the surface");
    VoxelLabels labels;
    labels.size = surface.size;
    findRuns(surface, inside, labels);
    const std::vector<uint32_t> root = RunJoiner(labels).join();
    std::vector<uint8_t> outside(root.size(), 0);
    const ivec3 last = surface.size - ivec3(1);
    forAllRuns(labels, [&](uint32_t k, int y, int z, int first, int end) {
        if (labels.runs[k].label != kOpen) return;
        if (y == 0 || z == 0 || y == last.y || z == last.z || first == 0 || end == last.x) outside[root[k]] = 1;
        if (inside != nullptr) labels.runs[k].label = kCavity;  // unless outside
    });
    numberRegions(labels, root, outside, surface.voxel);
    return labels;
}

VoxelLabels labelsOf(const VoxelGrid& surface, std::span<const uint32_t> region, uint32_t regions) {
    ASSERT(region.size() == surface.count(), "give one region per voxel");
    VoxelLabels labels;
    labels.size = surface.size;
    findRuns(surface, nullptr, labels);
    std::vector<uint32_t> root(labels.runs.size()), firstRun(regions, kNoRun);
    std::vector<uint8_t> outside(labels.runs.size(), 0);
    forAllRuns(labels, [&](uint32_t k, int y, int z, int first, int) {
        if (labels.runs[k].label == kInsideSurface) return;
        const uint32_t of = region[surface.index({first, y, z})];
        ASSERT(of < regions, "a region's number must be below their count");
        if (firstRun[of] == kNoRun) firstRun[of] = k;
        root[k] = firstRun[of];
        outside[k] = of == 0 ? 1 : 0;
    });
    numberRegions(labels, root, outside, surface.voxel);
    return labels;
}

VoxelGrid solidBits(const VoxelLabels& labels, const VoxelGrid& like) {
    ASSERT(labels.size == like.size, "labels and grid must have the same size");
    VoxelGrid solid{like.size, like.origin, like.voxel, {}};
    solid.bits.assign((like.count() + 31) / 32 * 4, 0);
    forVoxels(labels, [&](size_t first, size_t last, uint32_t label) {
        if (label != kOutside) setBits(solid.bits, first, last);
    });
    return solid;
}

std::vector<uint8_t> reachableFromBorder(const VoxelGrid& surface) {
    std::vector<uint8_t> reached(surface.count(), 0);
    forVoxels(labelRegions(surface, nullptr), [&](size_t first, size_t last, uint32_t label) {
        if (label == kOutside) std::memset(&reached[first], 1, last - first + 1);
    });
    return reached;
}

}  // namespace rivulet
