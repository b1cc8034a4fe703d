// The cpu's part of host_force_test.cpp: the host's kernel compiled as C++, for any processor.
#define RIVULET_KERNEL_UNIT host_force_unit
#include "tests/parity/host_force_kernels.h"

#include "shaders/common/lang.h"

namespace rivulet::host_force_unit {
#include "tests/parity/host_swirl.kernel"
}  // namespace rivulet::host_force_unit

namespace rivulet {

CpuKernelRow hostSwirl() { return {"host/host_swirl", "", Isa::generic, host_force_unit::host_swirl, 1024}; }

}  // namespace rivulet
