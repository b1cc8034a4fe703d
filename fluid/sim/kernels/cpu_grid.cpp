#include "fluid/sim/kernels/cpu_grid.h"

#include "shaders/common/lang.h"
#include "shaders/fluid/grid/repeats.h"

namespace rivulet::RIVULET_KERNEL_UNIT {
namespace {

using Job = CpuGridJob;

struct Range {
    uint32_t begin, end;
};
INLINE Range part(uint32_t count, uint32_t parts, uint32_t k) {
    return {static_cast<uint32_t>(uint64_t{count} * k / parts), static_cast<uint32_t>(uint64_t{count} * (k + 1) / parts)};
}

// The number of the cell of `g`, in cells from the grid's origin, where cells repeat in space.
INLINE int cellOnce(float g, int cells) { return repeatedCell(static_cast<int>(floor(g)), 1, cells - 2); }
// The same of half cells along x.
INLINE int halfCellOnce(float g, int cells) { return repeatedCell(static_cast<int>(floor(2.0F * g)), 2, 2 * (cells - 2)); }

// A thread for each chunk of particles: their cells and the histogram of the chunk.
void sortCount(uint32_t begin, uint32_t end, const void* params, void* const*) {
    const Job& job = *static_cast<const Job*>(params);
    const uint32_t cells = job.cells(), total = job.totalCells;
    const float limitX = static_cast<float>(job.cellsX - 1), limitY = static_cast<float>(job.cellsY - 1),
                limitZ = static_cast<float>(job.cellsZ - 1);
    for (uint32_t c = begin; c < end; ++c) {
        uint32_t* histogram = job.histogram + size_t{c} * job.bins();
        memset(histogram, 0, job.bins() * sizeof(uint32_t));
        const Range r = part(job.count, job.chunks, c);
        for (uint32_t i = r.begin; i < r.end; ++i) {
            const Float4& p = job.position[i];
            const float gx = (p.x - job.originX) * job.scaleX, gy = (p.y - job.originY) * job.scaleY, gz = (p.z - job.originZ) * job.scaleZ;
            // Outside the unpadded cells, or NaN (every comparison false): lost.
            const bool inside = (gx >= 1.0F) & (gx < limitX) & (gy >= 1.0F) & (gy < limitY) & (gz >= 1.0F) & (gz < limitZ);
            const bool sample = job.id[i] >= job.firstSample;
            uint32_t cell = total + (sample ? 0U : 1U);
            if (job.repeats && fabsf(gx) < FARTHEST_CELL && fabsf(gy) < FARTHEST_CELL && fabsf(gz) < FARTHEST_CELL)
                cell = static_cast<uint32_t>((cellOnce(gz, job.cellsZ) * job.cellsY + cellOnce(gy, job.cellsY)) * 2 * job.cellsX +
                                             halfCellOnce(gx, job.cellsX));
            else if (inside)
                cell = (static_cast<uint32_t>(static_cast<int>(gz)) * static_cast<uint32_t>(job.cellsY) +
                        static_cast<uint32_t>(static_cast<int>(gy))) *
                           static_cast<uint32_t>(2 * job.cellsX) +
                       static_cast<uint32_t>(static_cast<int>(2.0F * gx)) + (sample ? cells : 0U);
            if (p.w < 0.0F && !sample) cell = total + 2;
            if (job.sortsAsleep && job.velocity[i].w < 0.0F && cell < cells) cell += total + 3;
            job.cell[i] = cell;
            ++histogram[cell];
        }
    }
}

// A thread for each segment of cells: the number of its particles in all chunks.
void sortSegmentSums(uint32_t begin, uint32_t end, const void* params, void* const*) {
    const Job& job = *static_cast<const Job*>(params);
    const uint32_t bins = job.bins();
    for (uint32_t s = begin; s < end; ++s) {
        const Range r = part(bins, kScanSegments, s);
        uint32_t sum = 0;
        for (uint32_t c = 0; c < job.chunks; ++c) {
            const uint32_t* histogram = job.histogram + size_t{c} * bins;
            for (uint32_t cell = r.begin; cell < r.end; ++cell) sum += histogram[cell];
        }
        job.segmentSum[s] = sum;
    }
}

// A thread for each segment: turns histograms into destinations (of each chunk's particles in a cell), and writes cellStart.
void sortOffsets(uint32_t begin, uint32_t end, const void* params, void* const*) {
    const Job& job = *static_cast<const Job*>(params);
    const uint32_t bins = job.bins();
    for (uint32_t s = begin; s < end; ++s) {
        const Range r = part(bins, kScanSegments, s);
        uint32_t sum = 0;
        for (uint32_t k = 0; k < s; ++k) sum += job.segmentSum[k];
        for (uint32_t cell = r.begin; cell < r.end; ++cell) {
            job.cellStart[cell] = sum;
            for (uint32_t c = 0; c < job.chunks; ++c) {
                uint32_t& slot = job.histogram[size_t{c} * bins + cell];
                const uint32_t held = slot;
                slot = sum;
                sum += held;
            }
        }
        if (s + 1 == kScanSegments) job.cellStart[bins] = sum;
    }
}

// A thread for each chunk: a stable scatter, so that the order does not depend on the number of chunks.
void sortScatter(uint32_t begin, uint32_t end, const void* params, void* const*) {
    const Job& job = *static_cast<const Job*>(params);
    for (uint32_t c = begin; c < end; ++c) {
        uint32_t* next = job.histogram + size_t{c} * job.bins();
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
// The indices of the kept lanes as bytes, packed by pext and widened to a vector.
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

// The box around a group's particles.
struct GroupBox {
    float loX, loY, loZ, hiX, hiY, hiZ;
    int cy, cz;  // of all of them
};
INLINE GroupBox boxOf(const Job& job, const CpuGroup& group) {
    real px = load8(job.x + group.first), py = load8(job.y + group.first), pz = load8(job.z + group.first);
    if (group.lanes < 8) {
        const LaneMask lane = {0, 1, 2, 3, 4, 5, 6, 7};
        const LaneMask used = lane < static_cast<int>(group.lanes);
        px = select(used, px, real(px.v[0]));
        py = select(used, py, real(py.v[0]));
        pz = select(used, pz, real(pz.v[0]));
    }
    const float gy = (py.v[0] - job.originY) * job.scaleY, gz = (pz.v[0] - job.originZ) * job.scaleZ;
    return {minLane(px),
            minLane(py),
            minLane(pz),
            maxLane(px),
            maxLane(py),
            maxLane(pz),
            job.repeats ? cellOnce(gy, job.cellsY) : static_cast<int>(gy),
            job.repeats ? cellOnce(gz, job.cellsZ) : static_cast<int>(gz)};
}

// Largest number of stretches of sorted particles with a group's candidates: nine rows, two pieces where a row wraps, fluid, samples and
// sleeping particles.
constexpr uint32_t kMostStretches = 54;
struct Stretches {
    uint32_t from[kMostStretches], to[kMostStretches], count = 0, atMost = 0;
    INLINE void add(const uint32_t* row, int x0, int x1) {
        from[count] = row[x0];
        to[count] = row[x1 + 1];
        atMost += to[count] - from[count];
        ++count;
    }
};

INLINE const uint32_t* rowOf(const Job& job, uint32_t firstCell, int y, int z) {
    return job.cellStart + firstCell +
           (static_cast<size_t>(z) * static_cast<size_t>(job.cellsY) + static_cast<size_t>(y)) * static_cast<size_t>(2 * job.cellsX);
}

INLINE void findStretches(const Job& job, const GroupBox& b, uint32_t firstCell, Stretches& to) {
    const int rowLength = 2 * job.cellsX;
    const float h2 = job.reach * job.reach, edgeY = 1.0F / job.scaleY, edgeZ = 1.0F / job.scaleZ;
    for (int dz = -1; dz <= 1; ++dz)
        for (int dy = -1; dy <= 1; ++dy) {
            // The row's distance from the group's box limits the stretch of x in which neighbours can lie.
            const float rowY = job.originY + static_cast<float>(b.cy + dy) * edgeY,
                        rowZ = job.originZ + static_cast<float>(b.cz + dz) * edgeZ;
            const float gapY = dy < 0 ? b.loY - (rowY + edgeY) : dy > 0 ? rowY - b.hiY : 0.0F;
            const float gapZ = dz < 0 ? b.loZ - (rowZ + edgeZ) : dz > 0 ? rowZ - b.hiZ : 0.0F;
            const float gap2 = max0(gapY) * max0(gapY) + max0(gapZ) * max0(gapZ);
            if (gap2 >= h2) continue;
            // Slightly wider than exact: rounding of the cell index must not lose a neighbour.
            const float reach = sqrt(h2 - gap2) + 1.0e-4F * job.reach;
            const int x0 = max(static_cast<int>((b.loX - reach - job.originX) * 2.0F * job.scaleX), 0);
            const int x1 = min(static_cast<int>((b.hiX + reach - job.originX) * 2.0F * job.scaleX), rowLength - 1);
            to.add(rowOf(job, firstCell, b.cy + dy, b.cz + dz), x0, x1);
        }
}

// findStretches for periodic axes: rows and their ends wrap round, and no cell occurs twice.
INLINE void findWrapped(const Job& job, const GroupBox& b, uint32_t firstCell, Stretches& to) {
    const auto around = [](int c, int n, bool periodic, int cells[3]) {
        int count = 0;
        for (int d = -1; d <= 1; ++d) {
            int k = c + d;
            if (periodic) k = k < 1 ? n - 2 : k > n - 2 ? 1 : k;
            bool known = false;
            for (int m = 0; m < count; ++m) known = known || cells[m] == k;
            if (!known) cells[count++] = k;
        }
        return count;
    };
    int ys[3], zs[3];
    const int ny = around(b.cy, job.cellsY, job.periodY > 0, ys), nz = around(b.cz, job.cellsZ, job.periodZ > 0, zs);
    const float reach = job.reach * 1.0001F;
    int x0 = static_cast<int>(floor((b.loX - reach - job.originX) * 2.0F * job.scaleX));
    int x1 = static_cast<int>(floor((b.hiX + reach - job.originX) * 2.0F * job.scaleX));
    const int first = 2, last = 2 * job.cellsX - 3, turn = last - first + 1;  // the half cells that are not padding
    if (job.repeats) {
        const int from = repeatedCell(x0, first, turn);
        x1 += from - x0;
        x0 = from;
    }
    for (int z = 0; z < nz; ++z)
        for (int y = 0; y < ny; ++y) {
            const uint32_t* row = rowOf(job, firstCell, ys[y], zs[z]);
            if (!(job.periodX > 0)) {
                to.add(row, max(x0, 0), min(x1, 2 * job.cellsX - 1));
            } else if (x1 - x0 + 1 >= turn) {
                to.add(row, first, last);
            } else {
                to.add(row, max(x0, first), min(x1, last));
                if (x0 < first) to.add(row, x0 + turn, last);
                if (x1 > last) to.add(row, first, x1 - turn);
            }
        }
}

// Distance (m) of `x` from [lo, hi], by the shortest way round where the axis is periodic.
INLINE real outside(real x, float lo, float hi, float period, float invPeriod) {
    const real d = x - real(0.5F * (lo + hi));
    const real near = d - floor(d * real(invPeriod) + real(0.5F)) * real(period);
    return max0(max(near, -near) - real(0.5F * (hi - lo)));
}

// A thread for each group: lists every particle within reach of the box around the group. The first sweep drops entries that no lane needs.
// Entries beyond the capacity are counted and not written: the host sees the cursor, makes room for that many, and has them listed again.
template <bool periodic>
INLINE void listNeighbors(uint32_t begin, uint32_t end, const Job& job) {
    const float h2 = periodic ? job.reach * job.reach * 1.0001F : job.reach * job.reach;
    const uint32_t cells = job.cells();
    const float invX = job.periodX > 0 ? 1.0F / job.periodX : 0.0F, invY = job.periodY > 0 ? 1.0F / job.periodY : 0.0F,
                invZ = job.periodZ > 0 ? 1.0F / job.periodZ : 0.0F;
    uint64_t at = 0, regionEnd = 0;
    for (uint32_t g = begin; g < end; ++g) {
        CpuGroup& group = job.groups[g];
        const GroupBox b = boxOf(job, group);
        Stretches s;
        const bool ofFluid = group.first < job.cellStart[cells];
        const auto find = [&](uint32_t firstCell) {
            if (periodic)
                findWrapped(job, b, firstCell, s);
            else
                findStretches(job, b, firstCell, s);
        };
        find(0);
        if (job.totalCells > cells && ofFluid) find(cells);  // samples do not interact
        if (job.asleepCells > 0) find(job.totalCells + 3);
        if (at + s.atMost + 8 > regionEnd) {
            const uint64_t take = s.atMost + 8 > kListRegion ? s.atMost + 8 : kListRegion;
            at = __atomic_fetch_add(job.listCursor, take, __ATOMIC_ACQUIRE);
            regionEnd = at + take;
        }
        const bool fits = regionEnd <= job.listCapacity;
        uint32_t spare[8];
        uint32_t* const list = fits ? job.list : spare;
        const uint32_t written = fits ? ~0U : 0U;
        const uint32_t first = static_cast<uint32_t>(at);  // exact if it fits
        uint32_t next = first;
        for (uint32_t r = 0; r < s.count; ++r)
            for (uint32_t j = s.from[r]; j < s.to[r]; j += 8) {
                const real x = load8(job.x + j), y = load8(job.y + j), z = load8(job.z + j);
                real dx, dy, dz;
                if (periodic) {
                    dx = outside(x, b.loX, b.hiX, job.periodX, invX);
                    dy = outside(y, b.loY, b.hiY, job.periodY, invY);
                    dz = outside(z, b.loZ, b.hiZ, job.periodZ, invZ);
                } else {
                    dx = max0(max(real(b.loX) - x, x - real(b.hiX)));
                    dy = max0(max(real(b.loY) - y, y - real(b.hiY)));
                    dz = max0(max(real(b.loZ) - z, z - real(b.hiZ)));
                }
                const real d2 = dx * dx + dy * dy + dz * dz;
                LaneMask keep = d2 < real(h2);
                if (j + 8 > s.to[r]) {
                    const LaneMask lane = {0, 1, 2, 3, 4, 5, 6, 7};
                    keep &= lane < static_cast<int>(s.to[r] - j);
                }
                next += appendLanes(list + (next & written), j, keep);
            }
        at += next - first;
        group.listBegin = first;
        group.listCount = group.seenCount = (next - first) & written;
    }
    // The rest of the last region goes back, unless another chunk has taken the next one. Of a region beyond the capacity nothing does: the
    // cursor tells the host that lists are missing.
    if (at < regionEnd && regionEnd <= job.listCapacity)
        __atomic_compare_exchange_n(job.listCursor, &regionEnd, at, false, __ATOMIC_RELEASE, __ATOMIC_RELAXED);
}
void neighborList(uint32_t begin, uint32_t end, const void* params, void* const*) {
    listNeighbors<false>(begin, end, *static_cast<const Job*>(params));
}
void neighborListPeriodic(uint32_t begin, uint32_t end, const void* params, void* const*) {
    listNeighbors<true>(begin, end, *static_cast<const Job*>(params));
}

}  // namespace

CpuGridKernels gridKernels() { return {sortCount, sortSegmentSums, sortOffsets, sortScatter, neighborList, neighborListPeriodic}; }

}  // namespace rivulet::RIVULET_KERNEL_UNIT
