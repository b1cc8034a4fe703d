#include "fluid/sim/world/cpu_kernels.h"

#include "fluid/sim/kernels/cpu_grid.h"

#if defined(RIVULET_HAS_GENERIC)
RIVULET_GRID_UNIT(kernels_generic)
#endif
#if defined(RIVULET_HAS_AVX2)
RIVULET_GRID_UNIT(kernels_avx2)
#endif
#if defined(RIVULET_HAS_AVX512)
RIVULET_GRID_UNIT(kernels_avx512)
#endif

namespace rivulet {

std::span<const CpuKernelRow> compiledKernels();  // written by engine/compute/compile_kernels.cmake

std::vector<CpuKernelRow> cpuKernels() {
    const std::span<const CpuKernelRow> compiled = compiledKernels();
    std::vector<CpuKernelRow> all(compiled.begin(), compiled.end());
    const auto addGrid = [&all](Isa isa, const CpuGridKernels& grid) {
        all.push_back({"fluid/grid/cpu_sort_count", "", isa, grid.sortCount, 1});
        all.push_back({"fluid/grid/cpu_sort_segments", "", isa, grid.sortSegments, 1});
        all.push_back({"fluid/grid/cpu_sort_offsets", "", isa, grid.sortOffsets, 1});
        all.push_back({"fluid/grid/cpu_sort_scatter", "", isa, grid.sortScatter, 1});
        all.push_back({"fluid/grid/cpu_neighbor_list", "", isa, grid.neighborList, 64});
        all.push_back({"fluid/grid/cpu_neighbor_list", "PERIODIC=1", isa, grid.neighborListPeriodic, 64});
    };
#if defined(RIVULET_HAS_GENERIC)
    addGrid(Isa::generic, kernels_generic::gridKernels());
#endif
#if defined(RIVULET_HAS_AVX2)
    addGrid(Isa::avx2, kernels_avx2::gridKernels());
#endif
#if defined(RIVULET_HAS_AVX512)
    addGrid(Isa::avx512, kernels_avx512::gridKernels());
#endif
    return all;
}

}  // namespace rivulet
