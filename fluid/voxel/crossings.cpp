#include "fluid/voxel/crossings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <new>
#include <string>

#include "engine/core/assert.h"
#include "engine/core/parallel.h"
#include "shaders/fluid/grid/scan_params.h"
#include "shaders/voxel/crossing.h"

namespace rivulet {
namespace {

constexpr size_t kChunk = 2048;         // triangles per task
constexpr size_t kUpload = 256 * 1024;  // triangles at a time on a device: 28 MB

// A triangle in the layout of shaders/voxel/crossing.h.
struct Prepared {
    std::array<double, CROSSING_DOUBLES> numbers;
    int sense;
    int firstRow, endRow;
};

double reciprocal(double x) { return x != 0.0 ? 1.0 / x : 0.0; }

Prepared prepare(const Corners& t, const VoxelGrid& grid) {
    std::array<size_t, 3> order{0, 1, 2};
    int sense = 1;
    const auto sorted = [&](size_t i, size_t k) {
        if (t[order[i]].z <= t[order[k]].z) return;
        std::swap(order[i], order[k]);
        sense = -sense;
    };
    sorted(0, 1);
    sorted(1, 2);
    sorted(0, 1);
    const dvec3 &a = t[order[0]], &b = t[order[1]], &c = t[order[2]];
    const dvec3 ab = b - a, ac = c - a;
    const double nx = ab.y * ac.z - ab.z * ac.y;
    double slopeY = 0, slopeZ = 0;
    if (nx != 0.0) {
        slopeY = -(ab.z * ac.x - ab.x * ac.z) / nx;
        slopeZ = -(ab.x * ac.y - ab.y * ac.x) / nx;
        if (!std::isfinite(slopeY) || !std::isfinite(slopeZ)) slopeY = slopeZ = 0.0;
    }
    return {{a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z, reciprocal(ab.z), reciprocal(c.z - b.z), reciprocal(ac.z), slopeY, slopeZ},
            sense,
            centresBelow(a.z, grid.size.z),
            centresBelow(c.z, grid.size.z)};
}

size_t columnsOf(const VoxelGrid& grid) { return static_cast<size_t>(grid.size.y) * static_cast<size_t>(grid.size.z); }

struct Found {
    uint32_t column, crossing;
};

void crossTriangle(const Corners& corners, const VoxelGrid& grid, std::vector<Found>& found) {
    const Prepared p = prepare(corners, grid);
    for (int z = p.firstRow; z < p.endRow; ++z) {
        const CrossingRow row = crossingRow(p.numbers.data(), 0, p.sense, z, grid.size.y);
        const uint32_t base = static_cast<uint32_t>(z) * static_cast<uint32_t>(grid.size.y);
        for (int y = row.first; y < row.end; ++y) {
            const int x = crossingVoxel(row, y, grid.size.x);
            if (x >= grid.size.x) continue;
            found.push_back({base + static_cast<uint32_t>(y), (static_cast<uint32_t>(x) << 1U) | (row.sense > 0 ? 1U : 0U)});
        }
    }
}

// Sets bits [first, end) of the row-major order. No other thread may write the bytes at its ends.
void setRun(VoxelGrid& grid, size_t first, size_t end) {
    if (first >= end) return;
    const size_t low = first >> 3U, high = (end - 1) >> 3U;
    const unsigned lowMask = 0xFFU << (first & 7U), highMask = 0xFFU >> (7U - ((end - 1) & 7U));
    if (low == high) {
        grid.bits[low] = static_cast<uint8_t>(grid.bits[low] | (lowMask & highMask));
        return;
    }
    grid.bits[low] = static_cast<uint8_t>(grid.bits[low] | lowMask);
    std::memset(&grid.bits[low + 1], 0xFF, high - low - 1);
    grid.bits[high] = static_cast<uint8_t>(grid.bits[high] | highMask);
}

void sortAndSet(ColumnCrossings& crossings, VoxelGrid& grid) {
    // 32 columns fill whole words, so tasks share no word.
    const size_t columns = columnsOf(grid), blocks = (columns + 31) / 32, across = static_cast<size_t>(grid.size.x);
    parallelParts(blocks, 8, [&](size_t begin, size_t end) {
        for (size_t k = 32 * begin; k < std::min(32 * end, columns); ++k) {
            const auto first = crossings.items.begin() + crossings.start[k], last = crossings.items.begin() + crossings.start[k + 1];
            if (first == last) continue;
            std::sort(first, last);
            int winding = 0;
            size_t from = 0;
            for (auto item = first; item != last; ++item) {
                const auto to = static_cast<size_t>(crossedVoxel(*item));
                if (winding != 0) setRun(grid, k * across + from, k * across + to);
                winding += crossedChange(*item);
                from = to;
            }
            if (winding != 0) setRun(grid, k * across + from, (k + 1) * across);
        }
    });
}

}  // namespace

ColumnCrossings crossColumns(const CrossedTriangles& triangles, VoxelGrid& grid) {
    std::vector<std::vector<Found>> found((triangles.size() + kChunk - 1) / kChunk);
    parallelFor(size_t{0}, found.size(), [&](size_t chunk) {
        for (size_t k = chunk * kChunk; k < std::min((chunk + 1) * kChunk, triangles.size()); ++k)
            crossTriangle(triangles[k], grid, found[chunk]);
    });
    size_t total = 0;
    for (const auto& some : found) total += some.size();
    if (total > std::numeric_limits<uint32_t>::max()) throw std::bad_alloc();
    ColumnCrossings crossings;
    crossings.start.assign(columnsOf(grid) + 2, 0);
    for (const auto& some : found)
        for (const Found& f : some) ++crossings.start[f.column + 2];
    for (size_t k = 2; k < crossings.start.size(); ++k) crossings.start[k] += crossings.start[k - 1];
    crossings.items.resize(total);
    for (const auto& some : found)
        for (const Found& f : some) crossings.items[crossings.start[f.column + 1]++] = f.crossing;
    crossings.start.pop_back();
    sortAndSet(crossings, grid);
    return crossings;
}

namespace {

// Keeps the first Error of several allocations and kernels.
struct Taker {
    Device& device;
    Status status = ok();
    Buffer buffer(size_t bytes) {
        if (!status) return {};
        Result<Buffer> made = device.allocate(bytes);
        if (made) return std::move(*made);
        status = made.error();
        return {};
    }
    Kernel kernel(std::string_view path, std::span<const Define> defines = {}) {
        if (!status) return {};
        Result<Kernel> made = device.kernel(path, defines);
        if (made) return *made;
        status = failed(fmt::format("{} cannot voxelise, possibly because it has no 64-bit floats: {}; use the cpu.", device.info().name,
                                    made.error().message));
        return {};
    }
};

// Some triangles in the layout of the kernels, with their work items.
struct Batch {
    std::vector<double> numbers;
    std::vector<uint32_t> items;
};

Batch batchOf(const CrossedTriangles& triangles, size_t first, size_t last, const VoxelGrid& grid) {
    Batch batch;
    batch.numbers.reserve((last - first) * CROSSING_DOUBLES);
    for (size_t k = first; k < last; ++k) {
        const Prepared p = prepare(triangles[k], grid);
        if (p.firstRow >= p.endRow) continue;
        const auto number = static_cast<uint32_t>(batch.numbers.size() / CROSSING_DOUBLES);
        batch.numbers.insert(batch.numbers.end(), p.numbers.begin(), p.numbers.end());
        const int step = static_cast<int>(CROSSING_ROWS);
        for (int row = p.firstRow; row < p.endRow; row += step) {
            const int end = std::min(row + step, p.endRow);
            for (uint32_t n : {(number << 1U) | (p.sense > 0 ? 1U : 0U), static_cast<uint32_t>(row), static_cast<uint32_t>(end)})
                batch.items.push_back(n);
        }
    }
    return batch;
}

// Upper bound of the number of crossings, by the triangles' bounds.
double mostCrossings(const CrossedTriangles& triangles, const VoxelGrid& grid) {
    double most = 0;
    for (size_t k = 0; k < triangles.size(); ++k) {
        const Corners t = triangles[k];
        const dvec3 low = glm::min(t[0], glm::min(t[1], t[2])), high = glm::max(t[0], glm::max(t[1], t[2]));
        most += static_cast<double>(centresBelow(high.y, grid.size.y) - centresBelow(low.y, grid.size.y) + 1) *
                static_cast<double>(centresBelow(high.z, grid.size.z) - centresBelow(low.z, grid.size.z));
    }
    return most;
}

}  // namespace

Result<ColumnCrossings> crossColumnsOn(Device& device, const CrossedTriangles& triangles, VoxelGrid& grid, bool wanted) {
    ASSERT(grid.count() <= std::numeric_limits<uint32_t>::max(), "kernels count voxels in 32 bits: use the host for larger grids");
    if (mostCrossings(triangles, grid) > 4.0e9)
        return failed(fmt::format("{} triangles cross too many columns of {} x {} voxels for {}; lower the resolution or use the cpu.",
                                  triangles.size(), grid.size.y, grid.size.z, device.info().name));
    Taker take{device};
    const Define counting[] = {{"FILL", "0"}}, filling[] = {{"FILL", "1"}}, scanning[] = {{"LOCAL_SIZE", std::to_string(SCAN_THREADS)}};
    const Kernel count = take.kernel("voxel/voxelize_cross", counting), fill = take.kernel("voxel/voxelize_cross", filling);
    const Kernel reduce = take.kernel("fluid/grid/scan_reduce", scanning), blocks = take.kernel("fluid/grid/scan_blocks", scanning);
    const Kernel apply = take.kernel("fluid/grid/scan_apply", scanning), solid = take.kernel("voxel/voxelize_solid");
    const auto columns = static_cast<uint32_t>(columnsOf(grid));
    const ScanParams scan{columns + 1, (columns + 1 + SCAN_BLOCK - 1) / SCAN_BLOCK, 0, 0};
    Buffer counts = take.buffer((columns + size_t{1}) * sizeof(uint32_t)), starts = take.buffer(counts.bytes());
    Buffer places = take.buffer(counts.bytes()), sums = take.buffer(scan.blocks * sizeof(uint32_t));
    Buffer bits = take.buffer(grid.bits.size());
    if (!take.status) return take.status.error();

    CrossingParams params{grid.size.x, grid.size.y, grid.size.z, 0, static_cast<uint32_t>(grid.bits.size() / 4), 0, 0, 0};
    // All triangles, kUpload at a time; a list that fits is uploaded once.
    Buffer numbers, items;
    const auto eachBatch = [&](auto run) {
        for (size_t first = 0; first < triangles.size() && take.status; first += kUpload) {
            if (!numbers || triangles.size() > kUpload) {
                const Batch batch = batchOf(triangles, first, std::min(first + kUpload, triangles.size()), grid);
                params.items = static_cast<uint32_t>(batch.items.size() / CROSSING_ITEM);
                numbers = take.buffer(batch.numbers.size() * sizeof(double));
                items = take.buffer(batch.items.size() * sizeof(uint32_t));
                if (!take.status) return;
                device.writeAll<double>(numbers, batch.numbers);
                device.writeAll<uint32_t>(items, batch.items);
            }
            run();
        }
    };
    eachBatch([&] { device.run(count, params, {&numbers, &items, &counts}, params.items); });
    device.run(reduce, scan, {&counts, &sums}, scan.blocks * SCAN_THREADS);
    device.run(blocks, scan, {&sums}, SCAN_THREADS);
    device.run(apply, scan, {&counts, &sums, &starts}, scan.blocks * SCAN_THREADS);
    if (!take.status) return take.status.error();
    ColumnCrossings crossings;
    crossings.start = device.readAll<uint32_t>(starts, columns + size_t{1});
    Buffer found = take.buffer(std::max<size_t>(crossings.start.back(), 1) * sizeof(uint32_t));
    if (!take.status) return take.status.error();
    device.copy(starts, places, starts.bytes());
    eachBatch([&] { device.run(fill, params, {&numbers, &items, &places, &found}, params.items); });
    if (!take.status) return take.status.error();

    uint32_t deepest = 0;
    for (size_t k = 0; k < columns; ++k) deepest = std::max(deepest, crossings.start[k + 1] - crossings.start[k]);
    const bool here = deepest > CROSSING_DEEPEST;
    if (wanted || here) crossings.items = device.readAll<uint32_t>(found, crossings.start.back());
    if (wanted || here) sortAndSet(crossings, grid);
    if (!here) {
        device.run(solid, params, {&starts, &found, &bits}, params.words);
        device.read(bits, std::as_writable_bytes(std::span(grid.bits)));
    }
    return crossings;
}

}  // namespace rivulet
