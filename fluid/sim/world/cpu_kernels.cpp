#include "fluid/sim/world/cpu_kernels.h"

#include "fluid/sim/kernels/kernel_rows.h"

#if defined(RIVULET_HAS_GENERIC)
RIVULET_KERNEL_FAMILIES(kernels_generic)
#endif
#if defined(RIVULET_HAS_AVX2)
RIVULET_KERNEL_FAMILIES(kernels_avx2)
#endif
#if defined(RIVULET_HAS_AVX512)
RIVULET_KERNEL_FAMILIES(kernels_avx512)
#endif

namespace rivulet {

std::vector<CpuKernelRow> cpuKernels() {
    std::vector<CpuKernelRow> all;
    auto add = [&all](std::span<const CpuKernelRow> rows) { all.insert(all.end(), rows.begin(), rows.end()); };
#if defined(RIVULET_HAS_GENERIC)
    add(kernels_generic::gridRows());
    add(kernels_generic::particleRows());
    add(kernels_generic::wcsphRows());
    add(kernels_generic::solverRows());
    add(kernels_generic::emissionRows());
    add(kernels_generic::bodyRows());
    add(kernels_generic::queryRows());
    add(kernels_generic::forceRows());
    add(kernels_generic::foamRows());
    add(kernels_generic::flowRows());
    add(kernels_generic::deformRows());
    add(kernels_generic::flowMapRows());
#endif
#if defined(RIVULET_HAS_AVX2)
    add(kernels_avx2::gridRows());
    add(kernels_avx2::particleRows());
    add(kernels_avx2::wcsphRows());
    add(kernels_avx2::solverRows());
    add(kernels_avx2::emissionRows());
    add(kernels_avx2::bodyRows());
    add(kernels_avx2::queryRows());
    add(kernels_avx2::forceRows());
    add(kernels_avx2::foamRows());
    add(kernels_avx2::flowRows());
    add(kernels_avx2::deformRows());
    add(kernels_avx2::flowMapRows());
#endif
#if defined(RIVULET_HAS_AVX512)
    add(kernels_avx512::gridRows());
    add(kernels_avx512::particleRows());
    add(kernels_avx512::wcsphRows());
    add(kernels_avx512::solverRows());
    add(kernels_avx512::emissionRows());
    add(kernels_avx512::bodyRows());
    add(kernels_avx512::queryRows());
    add(kernels_avx512::forceRows());
    add(kernels_avx512::foamRows());
    add(kernels_avx512::flowRows());
    add(kernels_avx512::deformRows());
    add(kernels_avx512::flowMapRows());
#endif
    return all;
}

}  // namespace rivulet
