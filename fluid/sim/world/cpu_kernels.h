// Every kernel compiled as C++, for every instruction set: the rows for makeCpuDevice.
#pragma once

#include <vector>

#include "engine/compute/device_cpu.h"

namespace rivulet {

std::vector<CpuKernelRow> cpuKernels();

}  // namespace rivulet
