#include "fluid/sim/kernels/cpu_grid.h"

#include "fluid/sim/kernels/kernel_rows.h"
#include "shaders/common/lang.h"

namespace rivulet::RIVULET_KERNEL_UNIT {
namespace {

using Job = CpuGridJob;

struct Range {
    uint32_t begin, end;
};
INLINE Range part(uint32_t count, uint32_t parts, uint32_t k) {
    return {static_cast<uint32_t>(uint64_t{count} * k / parts), static_cast<uint32_t>(uint64_t{count} * (k + 1) / parts)};
}

// One thread a chunk of particles: their cells and the chunk's histogram.
void sortCount(uint32_t begin, uint32_t end, const void* params, void* const*) {
    const Job& job = *static_cast<const Job*>(params);
    const uint32_t cells = job.cells();
    const float limitX = static_cast<float>(job.cellsX - 1), limitY = static_cast<float>(job.cellsY - 1),
                limitZ = static_cast<float>(job.cellsZ - 1);
    for (uint32_t c = begin; c < end; ++c) {
        uint32_t* histogram = job.histogram + size_t{c} * (cells + 1);
        memset(histogram, 0, (cells + 1) * sizeof(uint32_t));
        const Range r = part(job.count, job.chunks, c);
        for (uint32_t i = r.begin; i < r.end; ++i) {
            const Float4& p = job.position[i];
            const float gx = (p.x - job.originX) * job.invH, gy = (p.y - job.originY) * job.invH, gz = (p.z - job.originZ) * job.invH;
            // Outside the unpadded cells, or NaN (every comparison false): limbo.
            const bool inside = (gx >= 1.0F) & (gx < limitX) & (gy >= 1.0F) & (gy < limitY) & (gz >= 1.0F) & (gz < limitZ);
            uint32_t cell = cells;
            if (inside)
                cell = (static_cast<uint32_t>(static_cast<int>(gz)) * static_cast<uint32_t>(job.cellsY) +
                        static_cast<uint32_t>(static_cast<int>(gy))) *
                           static_cast<uint32_t>(2 * job.cellsX) +
                       static_cast<uint32_t>(static_cast<int>(2.0F * gx));
            job.cell[i] = cell;
            ++histogram[cell];
        }
    }
}

// One thread a segment of cells: how many particles it holds, over all chunks.
void sortSegmentSums(uint32_t begin, uint32_t end, const void* params, void* const*) {
    const Job& job = *static_cast<const Job*>(params);
    const uint32_t cells = job.cells();
    for (uint32_t s = begin; s < end; ++s) {
        const Range r = part(cells, kScanSegments, s);
        uint32_t sum = 0;
        for (uint32_t c = 0; c < job.chunks; ++c) {
            const uint32_t* histogram = job.histogram + size_t{c} * (cells + 1);
            for (uint32_t cell = r.begin; cell < r.end; ++cell) sum += histogram[cell];
        }
        job.segmentSum[s] = sum;
    }
}

// One thread a segment: turns histograms into where each chunk's particles of a cell go, and writes cellStart.
void sortOffsets(uint32_t begin, uint32_t end, const void* params, void* const*) {
    const Job& job = *static_cast<const Job*>(params);
    const uint32_t cells = job.cells();
    for (uint32_t s = begin; s < end; ++s) {
        const Range r = part(cells, kScanSegments, s);
        uint32_t sum = 0;
        for (uint32_t k = 0; k < s; ++k) sum += job.segmentSum[k];
        for (uint32_t cell = r.begin; cell < r.end; ++cell) {
            job.cellStart[cell] = sum;
            for (uint32_t c = 0; c < job.chunks; ++c) {
                uint32_t& slot = job.histogram[size_t{c} * (cells + 1) + cell];
                const uint32_t held = slot;
                slot = sum;
                sum += held;
            }
        }
        if (s + 1 == kScanSegments) {
            job.cellStart[cells] = sum;
            for (uint32_t c = 0; c < job.chunks; ++c) {
                uint32_t& slot = job.histogram[size_t{c} * (cells + 1) + cells];
                const uint32_t held = slot;
                slot = sum;
                sum += held;
            }
            job.cellStart[cells + 1] = sum;
        }
    }
}

// One thread a chunk: a stable scatter, so that the order does not depend on how many chunks there are.
void sortScatter(uint32_t begin, uint32_t end, const void* params, void* const*) {
    const Job& job = *static_cast<const Job*>(params);
    const uint32_t cells = job.cells();
    for (uint32_t c = begin; c < end; ++c) {
        uint32_t* next = job.histogram + size_t{c} * (cells + 1);
        const Range r = part(job.count, job.chunks, c);
        for (uint32_t i = r.begin; i < r.end; ++i) {
            const uint32_t to = next[job.cell[i]]++;
            const Float4 p = job.position[i];
            job.positionOut[to] = p;
            job.velocityOut[to] = job.velocity[i];
            job.idOut[to] = job.id[i];
            job.x[to] = p.x;
            job.y[to] = p.y;
            job.z[to] = p.z;
        }
    }
}

#if defined(__AVX512VL__)
INLINE uint32_t appendLanes(uint32_t* to, uint32_t first, LaneMask keep) {
    const __m256i lanes = _mm256_add_epi32(_mm256_set1_epi32(static_cast<int>(first)), _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7));
    const __mmask8 mask = _mm256_movepi32_mask(reinterpret_cast<__m256i>(keep));
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(to), _mm256_maskz_compress_epi32(mask, lanes));
    return static_cast<uint32_t>(__builtin_popcount(mask));
}
#elif defined(__AVX2__) && defined(__BMI2__)
// The kept lanes' numbers as bytes, packed by pext, widened to a vector.
INLINE uint32_t appendLanes(uint32_t* to, uint32_t first, LaneMask keep) {
    const uint32_t mask = static_cast<uint32_t>(_mm256_movemask_ps(reinterpret_cast<__m256>(keep)));
    const uint64_t bytes = _pext_u64(0x0706050403020100ULL, _pdep_u64(mask, 0x0101010101010101ULL) * 0xFFU);
    const __m256i lanes = _mm256_cvtepu8_epi32(_mm_cvtsi64_si128(static_cast<long long>(bytes)));
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(to), _mm256_add_epi32(lanes, _mm256_set1_epi32(static_cast<int>(first))));
    return static_cast<uint32_t>(__builtin_popcount(mask));
}
#else
INLINE uint32_t appendLanes(uint32_t* to, uint32_t first, LaneMask keep) {
    uint32_t kept = 0;
    for (uint32_t k = 0; k < 8; ++k) {
        to[kept] = first + k;
        kept += static_cast<uint32_t>(keep[k]) & 1U;
    }
    return kept;
}
#endif

INLINE real load8(const float* p) {
    Lanes v;
    memcpy(&v, p, sizeof v);
    return v;
}

INLINE float minLane(const real& r) {
    const real a = min(r, real(__builtin_shufflevector(r.v, r.v, 4, 5, 6, 7, 0, 1, 2, 3)));
    const real b = min(a, real(__builtin_shufflevector(a.v, a.v, 2, 3, 0, 1, 6, 7, 4, 5)));
    return b.v[0] < b.v[1] ? b.v[0] : b.v[1];
}
INLINE float maxLane(const real& r) { return -minLane(-r); }

// One thread a group: every particle within h of the box around the group's particles. The first sweep drops what no lane needs.
void neighborList(uint32_t begin, uint32_t end, const void* params, void* const*) {
    const Job& job = *static_cast<const Job*>(params);
    const int rowLength = 2 * job.cellsX;
    const float h2 = job.h * job.h;
    uint32_t at = 0, regionEnd = 0;
    for (uint32_t g = begin; g < end; ++g) {
        CpuGroup& group = job.groups[g];
        real px = load8(job.x + group.first), py = load8(job.y + group.first), pz = load8(job.z + group.first);
        if (group.lanes < 8) {
            const LaneMask lane = {0, 1, 2, 3, 4, 5, 6, 7};
            const LaneMask used = lane < static_cast<int>(group.lanes);
            px = select(used, px, real(px.v[0]));
            py = select(used, py, real(py.v[0]));
            pz = select(used, pz, real(pz.v[0]));
        }
        const float loX = minLane(px), hiX = maxLane(px), loY = minLane(py), hiY = maxLane(py), loZ = minLane(pz), hiZ = maxLane(pz);
        const int cy = static_cast<int>((py.v[0] - job.originY) * job.invH), cz = static_cast<int>((pz.v[0] - job.originZ) * job.invH);
        uint32_t from[9], to[9], rows = 0, atMost = 0;
        for (int dz = -1; dz <= 1; ++dz)
            for (int dy = -1; dy <= 1; ++dy) {
                // The row's distance from the group's box narrows the stretch of x that can hold neighbours.
                const float rowY = job.originY + static_cast<float>(cy + dy) * job.h,
                            rowZ = job.originZ + static_cast<float>(cz + dz) * job.h;
                const float gapY = dy < 0 ? loY - (rowY + job.h) : dy > 0 ? rowY - hiY : 0.0F;
                const float gapZ = dz < 0 ? loZ - (rowZ + job.h) : dz > 0 ? rowZ - hiZ : 0.0F;
                const float gap2 = max0(gapY) * max0(gapY) + max0(gapZ) * max0(gapZ);
                if (gap2 >= h2) continue;
                // A hair wider than exact: rounding of the cell index must not lose a neighbour.
                const float reach = sqrt(h2 - gap2) + 1.0e-4F * job.h;
                const int x0 = max(static_cast<int>((loX - reach - job.originX) * 2.0F * job.invH), 0);
                const int x1 = min(static_cast<int>((hiX + reach - job.originX) * 2.0F * job.invH), rowLength - 1);
                const uint32_t* row =
                    job.cellStart + (static_cast<size_t>(cz + dz) * static_cast<size_t>(job.cellsY) + static_cast<size_t>(cy + dy)) *
                                        static_cast<size_t>(rowLength);
                from[rows] = row[x0];
                to[rows] = row[x1 + 1];
                atMost += to[rows] - from[rows];
                ++rows;
            }
        if (at + atMost + 8 > regionEnd) {
            const uint32_t take = atMost + 8 > kListRegion ? atMost + 8 : kListRegion;
            at = __atomic_fetch_add(job.listCursor, take, __ATOMIC_RELAXED);
            regionEnd = at + take;
        }
        group.listBegin = at;
        group.listCount = 0;
        if (regionEnd > job.listCapacity || regionEnd < at) continue;  // the host sees the cursor beyond the capacity, and builds again
        for (uint32_t r = 0; r < rows; ++r)
            for (uint32_t j = from[r]; j < to[r]; j += 8) {
                const real x = load8(job.x + j), y = load8(job.y + j), z = load8(job.z + j);
                const real dx = max0(max(real(loX) - x, x - real(hiX)));
                const real dy = max0(max(real(loY) - y, y - real(hiY)));
                const real dz = max0(max(real(loZ) - z, z - real(hiZ)));
                const real d2 = dx * dx + dy * dy + dz * dz;
                LaneMask keep = d2 < real(h2);
                if (j + 8 > to[r]) {
                    const LaneMask lane = {0, 1, 2, 3, 4, 5, 6, 7};
                    keep &= lane < static_cast<int>(to[r] - j);
                }
                at += appendLanes(job.list + at, j, keep);
            }
        group.listCount = at - group.listBegin;
    }
}

}  // namespace

std::span<const CpuKernelRow> gridRows() {
    static const CpuKernelRow rows[] = {
        {"fluid/cpu_sort_count", "", RIVULET_UNIT_ISA, sortCount, 1},
        {"fluid/cpu_sort_segments", "", RIVULET_UNIT_ISA, sortSegmentSums, 1},
        {"fluid/cpu_sort_offsets", "", RIVULET_UNIT_ISA, sortOffsets, 1},
        {"fluid/cpu_sort_scatter", "", RIVULET_UNIT_ISA, sortScatter, 1},
        {"fluid/cpu_neighbor_list", "", RIVULET_UNIT_ISA, neighborList, 64},
    };
    return rows;
}

}  // namespace rivulet::RIVULET_KERNEL_UNIT
