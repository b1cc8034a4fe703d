// A kernel outside Rivulet, compiled for the cpu by a host.
#pragma once

#include "engine/compute/device_cpu.h"

namespace rivulet {

CpuKernelRow hostSwirl();

}  // namespace rivulet
