// Every kernel that was compiled as C++, for every instruction set: what makeCpuDevice is given.
#pragma once

#include <vector>

#include "engine/compute/device_cpu.h"

namespace rivulet {

std::vector<CpuKernelRow> cpuKernels();

}  // namespace rivulet
