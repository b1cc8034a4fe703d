// The kernels as C++: each unit of this folder is compiled once an instruction set, inside a namespace of that name, so that no inline
// function compiled for one processor is linked into another's.
#pragma once

#include <span>

#include "engine/compute/device_cpu.h"

#define RIVULET_KERNEL_FAMILIES(isa)              \
    namespace rivulet::isa {                      \
    std::span<const CpuKernelRow> gridRows();     \
    std::span<const CpuKernelRow> particleRows(); \
    std::span<const CpuKernelRow> wcsphRows();    \
    std::span<const CpuKernelRow> solverRows();   \
    std::span<const CpuKernelRow> emissionRows(); \
    std::span<const CpuKernelRow> bodyRows();     \
    std::span<const CpuKernelRow> queryRows();    \
    std::span<const CpuKernelRow> forceRows();    \
    std::span<const CpuKernelRow> foamRows();     \
    std::span<const CpuKernelRow> flowRows();     \
    std::span<const CpuKernelRow> deformRows();   \
    std::span<const CpuKernelRow> flowMapRows();  \
    }
#if defined(RIVULET_KERNEL_UNIT)
#define RIVULET_ISA_OF_kernels_generic Isa::generic
#define RIVULET_ISA_OF_kernels_avx2 Isa::avx2
#define RIVULET_ISA_OF_kernels_avx512 Isa::avx512
#define RIVULET_PASTE2(a, b) a##b
#define RIVULET_PASTE(a, b) RIVULET_PASTE2(a, b)
#define RIVULET_UNIT_ISA RIVULET_PASTE(RIVULET_ISA_OF_, RIVULET_KERNEL_UNIT)
RIVULET_KERNEL_FAMILIES(RIVULET_KERNEL_UNIT)
#endif
