// Devices that run the work items of each kernel in another order. A kernel may not depend on it: groups and work items of a GPU run in any
// order, and some only when others have ended.
#pragma once

#include <memory>

#include "engine/compute/device_cpu.h"
#include "engine/compute/kernel_source.h"

namespace rivulet::races {

enum class Order { backwards, interleaved };

// Shaders whose lang.h numbers work items and groups in that order. Error (failed): lang.h has other lines than this expects.
Result<ShaderFiles> shadersIn(Order order);

// What compilers may make of NaN: min, max and clamp that return their second operand if either is NaN (as x86 does), or NaN; and !(a < b)
// as a >= b, as Mesa's optimiser has it. Without NaN all are the same.
enum class NanHabit { second, spreads, inverts };
Result<ShaderFiles> shadersWith(NanHabit habit);

// A cpu whose kernels run one work item after the other in that order, on one thread.
std::unique_ptr<CpuDevice> cpuIn(Order order);

}  // namespace rivulet::races
