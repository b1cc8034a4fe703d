// Device cl: kernels in OpenCL 1.2, on a GPU where there is one, else on whatever OpenCL offers (PoCL).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/compute/device.h"
#include "engine/compute/kernel_source.h"
#include "engine/core/log.h"

namespace rivulet {

// Kernels are read through `files`. Errors (Fault::failed): no OpenCL platform, no device that can compile kernels, no context.
// `log` hears of trouble that comes later, where there is no Result to say it in: a dispatch that the driver refused.
Result<std::unique_ptr<Device>> makeClDevice(const ShaderFiles& files, Log log = {});

// A sentence for each OpenCL device of this machine, the one that makeClDevice takes first; empty where there is none.
std::vector<std::string> describeClDevices();

}  // namespace rivulet
