// A kernel that Rivulet does not know, as a host compiles it for the cpu.
#pragma once

#include "engine/compute/device_cpu.h"

namespace rivulet {

CpuKernelRow hostSwirl();

}  // namespace rivulet
