// Neighbour structures of the CPU: a stable counting sort, groups of 8 particles, a neighbour list for each group.
// GPUs have other passes (they sort by atomics and sweep rows), so these are plain C++, compiled once for each instruction set.
//
// Cells are h wide in y and z and h / 2 in x: the sort along a row is then fine enough that 8 consecutive particles lie close together.
// Samples on bodies have a second set of cells behind those of the fluid; see shaders/fluid/grid/grid.h for the rest.
#pragma once

#include <cstdint>

namespace rivulet {

struct Float4 {
    float x, y, z, w;
};

// 8 lanes of one row of cells. Same layout as Group in shaders/common/lang_lanes.h.
struct CpuGroup {
    uint32_t first, lanes, listBegin, listCount, seenCount;
};
// Binding 1 of a pair kernel. Same layout as NeighborLists in lang_lanes.h.
struct CpuNeighborLists {
    const CpuGroup* groups;
    uint32_t* list;
    const CpuGroup* samples;  // the groups from the first of samples on
};

struct CpuGridJob {
    float originX, originY, originZ;
    float scaleX, scaleY, scaleZ;     // 1/m, as StepParams.gridScale
    float periodX, periodY, periodZ;  // m; 0 = not periodic
    float reach;                      // m, of the lists: h, or more where positions change before the next build
    int cellsX, cellsY, cellsZ;       // padded cells, as in StepParams; the sort has 2 * cellsX along x
    uint32_t totalCells;              // cells(), or twice that with body samples
    uint32_t firstSample;             // ids from here on are samples
    uint32_t count;                   // slots to sort: without those of particles that go on sleeping
    uint32_t asleepCells;             // that have particles: cells(), or 0 if nothing sleeps
    bool sortsAsleep;                 // the sleeping particles are sorted too, into cells of their own behind all others
    bool repeats;                     // cells repeat in space along all axes
    uint32_t chunks;                  // of the two-histogram sort
    uint32_t groupCount;
    uint32_t listCapacity;  // entries
    // Input (unsorted) and output (sorted).
    const Float4 *position, *velocity;
    const uint32_t* id;
    Float4 *positionOut, *velocityOut;
    uint32_t* idOut;
    float *x, *y, *z;      // sorted positions again, one array for each axis; 8 entries beyond the end may be read
    uint32_t* cell;        // of each unsorted particle
    uint32_t* histogram;   // chunks * bins()
    uint32_t* segmentSum;  // kScanSegments
    uint32_t* cellStart;   // totalCells + 4, and asleepCells; see shaders/fluid/grid/grid.h
    CpuGroup* groups;
    uint32_t* list;
    uint64_t* listCursor;  // entries in use; above listCapacity the lists do not fit
    uint32_t bins() const { return totalCells + 3 + (sortsAsleep ? asleepCells : 0); }
    uint32_t cells() const { return static_cast<uint32_t>(2 * cellsX) * static_cast<uint32_t>(cellsY) * static_cast<uint32_t>(cellsZ); }
};
inline constexpr uint32_t kScanSegments = 16;
inline constexpr uint32_t kListRegion = 8192;  // entries that a chunk of groups reserves at once

// The passes, in their order. Each is a CpuKernelFn (engine/compute/device_cpu.h) whose `params` is a CpuGridJob.
struct CpuGridKernels {
    using Pass = void (*)(uint32_t begin, uint32_t end, const void* params, void* const* buffers);
    Pass sortCount, sortSegments, sortOffsets, sortScatter, neighborList, neighborListPeriodic;
};

}  // namespace rivulet

#define RIVULET_GRID_UNIT(isa)    \
    namespace rivulet::isa {      \
    CpuGridKernels gridKernels(); \
    }
#if defined(RIVULET_KERNEL_UNIT)
RIVULET_GRID_UNIT(RIVULET_KERNEL_UNIT)
#endif
