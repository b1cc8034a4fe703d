#include "fluid/voxel/voxelize_surface.h"

#include <fmt/format.h>
#include <array>
#include <atomic>
#include <limits>
#include <new>

#include "engine/compute/device_cpu.h"
#include "engine/core/parallel.h"
#include "shaders/voxel/overlap.h"

namespace rivulet {
namespace {

constexpr double kTouch = 1e-9;               // voxels
constexpr double kSlopeTolerance = 1e-11;     // of an axis: largest part of x before the axis counts as sloped
constexpr double kOperationError = 4e-16;     // error of one operation in double, with a margin
constexpr size_t kSurfaceUpload = 64 * 1024;  // triangles at a time on a device: 29 MB

// A triangle in the layout of shaders/voxel/overlap.h.
struct PreparedOverlap {
    std::array<double, OVERLAP_DOUBLES> numbers{};
    std::array<int, OVERLAP_INTS> bounds{};  // 0, 1, 2: first voxel; 3, 4, 5: last; 6: level slabs; 7: slabs
    bool empty = false;                      // beyond the grid
    int wide() const { return bounds[4] - bounds[1] + 1; }
    int rows() const { return wide() * (bounds[5] - bounds[2] + 1); }
};

// a b - c d with an error of one or two ulp (Kahan's method).
double differenceOfProducts(double a, double b, double c, double d) {
    const double cd = c * d;
    return std::fma(a, b, -cd) + std::fma(-c, d, cd);
}

// True if the subtraction b - a has no rounding error (Knuth 1969).
bool exact(const dvec3& a, const dvec3& b) {
    const dvec3 d = b - a, back = d - b, lost = (b - (d - back)) - (a + back);
    return lost.x == 0.0 && lost.y == 0.0 && lost.z == 0.0;
}

class Slabs {
  public:
    Slabs(PreparedOverlap& p, double across) : p_(p), across_(across) {}
    // The triangle spans 0 to `extent` on the axis, with an error of `slack`.
    void add(const dvec3& axis, double extent, double slack) {
        const double half = 0.5 * (std::abs(axis.x) + std::abs(axis.y) + std::abs(axis.z));
        if (half == 0.0) return;
        const double reach = half * (1.0 + 2.0 * kTouch) + slack;
        Slab s{axis.y, axis.z, std::min(0.0, extent) - reach, std::max(0.0, extent) + reach, 0.0};
        const double alongX = std::abs(axis.x) * across_;
        if (alongX <= kSlopeTolerance * half) {
            s[2] -= alongX;
            s[3] += alongX;
            level_[levels_++] = s;
        } else {
            if (axis.x < 0.0) std::swap(s[2], s[3]);
            s[4] = 1.0 / axis.x;
            sloped_[slopes_++] = s;
        }
    }
    void write() {
        auto to = p_.numbers.begin() + 3;
        for (size_t k = 0; k < levels_; ++k) to = std::copy(level_[k].begin(), level_[k].end(), to);
        for (size_t k = 0; k < slopes_; ++k) to = std::copy(sloped_[k].begin(), sloped_[k].end(), to);
        p_.bounds[6] = static_cast<int>(levels_);
        p_.bounds[7] = static_cast<int>(levels_ + slopes_);
    }

  private:
    using Slab = std::array<double, OVERLAP_SLAB>;
    PreparedOverlap& p_;
    double across_;  // voxels along x that a centre may be away from corner a
    std::array<Slab, OVERLAP_SLABS> level_, sloped_;
    size_t levels_ = 0, slopes_ = 0;
};

void prepareOverlap(const GridTriangles& triangles, size_t k, const VoxelGrid& grid, PreparedOverlap& p) {
    const auto [a, b, c] = triangles.corners(k);
    const dvec3 ab = b - a, ac = c - a, bc = c - b;  // in the mesh's unit: usually exact
    const GridTriangle t{triangles.inVoxels(a), ab / triangles.voxel(), ac / triangles.voxel()};
    const dvec3 low = t.low(), high = t.high();
    ivec3 several(0);
    for (int i = 0; i < 3; ++i) {
        const double first = std::max(0.0, std::floor(low[i] - kTouch)), last = std::min(grid.size[i] - 1.0, std::floor(high[i] + kTouch));
        p.empty = !(first <= last);
        if (p.empty) return;
        p.bounds[static_cast<size_t>(i)] = static_cast<int>(first);
        p.bounds[static_cast<size_t>(i) + 3] = static_cast<int>(last);
        several[i] = std::floor(low[i] - kTouch) < std::floor(high[i] + kTouch) ? 1 : 0;
    }
    p.numbers[0] = t.a.x;
    p.numbers[1] = t.a.y;
    p.numbers[2] = t.a.z;
    Slabs slabs(p, high.x - low.x + 1.0);
    const int axes = several.x + several.y + several.z;
    if (axes >= 2) {  // else the triangle runs along a single row of voxels, and overlaps all of it
        if (axes == 3) {
            const dvec3 normal(differenceOfProducts(ab.y, ac.z, ab.z, ac.y), differenceOfProducts(ab.z, ac.x, ab.x, ac.z),
                               differenceOfProducts(ab.x, ac.y, ab.y, ac.x));
            // If the edge vectors are rounded, the normal of a triangle with almost no area is noise and may separate by no more than the
            // rounding error.
            const bool sure = exact(a, b) && exact(a, c);
            const double reach = glm::length(t.ab) + glm::length(t.ac) + 1.0;
            slabs.add(normal, 0.0, sure ? 0.0 : kOperationError * glm::length(ab) * glm::length(ac) * reach);
        }
        // Edges across the box's edges. Within a single layer of voxels only those across the layer's normal can separate.
        for (const auto& [e, other] : {std::pair{ab, t.ac}, std::pair{ac, t.ab}, std::pair{bc, t.ab}}) {
            if (axes == 3 || several.x == 0) slabs.add(dvec3(0.0, e.z, -e.y), e.z * other.y - e.y * other.z, 0.0);
            if (axes == 3 || several.y == 0) slabs.add(dvec3(-e.z, 0.0, e.x), e.x * other.z - e.z * other.x, 0.0);
            if (axes == 3 || several.z == 0) slabs.add(dvec3(e.y, -e.x, 0.0), e.y * other.x - e.x * other.y, 0.0);
        }
    }
    slabs.write();
}

// Sets bits [first, last] of the row-major order. Other threads may set adjacent bits at the same time.
void setRunAtomic(VoxelGrid& grid, size_t first, size_t last) {
    for (size_t byte = first >> 3U; byte <= last >> 3U; ++byte) {
        unsigned mask = 0xFFU;
        if (byte == first >> 3U) mask &= 0xFFU << (first & 7U);
        if (byte == last >> 3U) mask &= 0xFFU >> (7U - (last & 7U));
        std::atomic_ref<uint8_t> bits(grid.bits[byte]);
        if ((bits.load(std::memory_order_relaxed) & mask) != mask) bits.fetch_or(static_cast<uint8_t>(mask), std::memory_order_relaxed);
    }
}

void setTriangle(const PreparedOverlap& p, VoxelGrid& grid) {
    for (int z = p.bounds[2]; z <= p.bounds[5]; ++z) {
        for (int y = p.bounds[1]; y <= p.bounds[4]; ++y) {
            const OverlapRun run = overlapRow(p.numbers.data(), p.bounds.data(), 0, y, z);
            if (run.first > run.last) continue;
            const size_t row = grid.index({0, y, z});
            setRunAtomic(grid, row + static_cast<size_t>(run.first), row + static_cast<size_t>(run.last));
        }
    }
}

// Some triangles in the layout of the kernel, with their work items.
struct SurfaceBatch {
    std::vector<double> numbers;
    std::vector<int> bounds;
    std::vector<uint32_t> items;
};

SurfaceBatch surfaceBatchOf(const GridTriangles& triangles, size_t first, size_t end, const VoxelGrid& grid) {
    SurfaceBatch batch;
    PreparedOverlap p;
    for (size_t k = first; k < end; ++k) {
        prepareOverlap(triangles, k, grid, p);
        if (p.empty) continue;
        const auto number = static_cast<uint32_t>(batch.bounds.size() / OVERLAP_INTS), rows = static_cast<uint32_t>(p.rows());
        batch.numbers.insert(batch.numbers.end(), p.numbers.begin(), p.numbers.end());
        batch.bounds.insert(batch.bounds.end(), p.bounds.begin(), p.bounds.end());
        for (uint32_t row = 0; row < rows; row += OVERLAP_ROWS)
            for (uint32_t n : {number, row, std::min(row + OVERLAP_ROWS, rows)}) batch.items.push_back(n);
    }
    return batch;
}

Status onDevice(Device& device, const GridTriangles& triangles, VoxelGrid& grid) {
    const Result<Kernel> kernel = device.kernel("voxel/voxelize_surface");
    if (!kernel)
        return failed(fmt::format("{} cannot voxelise, possibly because it has no 64-bit floats: {}; use the cpu.", device.info().name,
                                  kernel.error().message));
    Result<Buffer> bits = device.allocate(grid.bits.size());
    if (!bits) return bits.error();
    device.writeAll<uint8_t>(*bits, grid.bits);
    for (size_t first = 0; first < triangles.size(); first += kSurfaceUpload) {
        const SurfaceBatch batch = surfaceBatchOf(triangles, first, std::min(first + kSurfaceUpload, triangles.size()), grid);
        Result<Buffer> numbers = device.allocate(batch.numbers.size() * sizeof(double));
        Result<Buffer> bounds = device.allocate(batch.bounds.size() * sizeof(int));
        Result<Buffer> items = device.allocate(batch.items.size() * sizeof(uint32_t));
        for (const Result<Buffer>* made : {&numbers, &bounds, &items})
            if (!*made) return made->error();
        device.writeAll<double>(*numbers, batch.numbers);
        device.writeAll<int>(*bounds, batch.bounds);
        device.writeAll<uint32_t>(*items, batch.items);
        const OverlapParams params{grid.size.x, grid.size.y, grid.size.z, static_cast<uint32_t>(batch.items.size() / OVERLAP_ITEM)};
        device.run(*kernel, params, {&*numbers, &*bounds, &*items, &*bits}, params.items);
    }
    device.read(*bits, std::as_writable_bytes(std::span(grid.bits)));
    return ok();
}

}  // namespace

void voxelizeSurface(const GridTriangles& triangles, VoxelGrid& grid) {
    parallelParts(triangles.size(), 256, [&](size_t begin, size_t end) {
        PreparedOverlap p;
        for (size_t k = begin; k != end; ++k) {
            prepareOverlap(triangles, k, grid, p);
            if (!p.empty) setTriangle(p, grid);
        }
    });
}

Status voxelizeSurface(Device& device, const GridTriangles& triangles, VoxelGrid& grid) {
    try {
        if (device.backend() == Backend::cpu) {
            const JobsScope scope(static_cast<CpuDevice&>(device).jobs());
            voxelizeSurface(triangles, grid);
        } else if (grid.count() > std::numeric_limits<uint32_t>::max()) {  // kernels count voxels in 32 bits
            voxelizeSurface(triangles, grid);
        } else {
            return onDevice(device, triangles, grid);
        }
        return ok();
    } catch (const std::bad_alloc&) {
        return failed("Not enough memory for surface voxels; lower the resolution.");
    }
}

}  // namespace rivulet
