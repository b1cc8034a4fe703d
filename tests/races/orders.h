// Devices that run the work items of each kernel in another order. A kernel may not depend on it: groups and work items of a GPU run in any
// order, and some only when others have ended.
#pragma once

#include <memory>
#include <string>

#include "engine/compute/device_cpu.h"
#include "engine/compute/kernel_source.h"

namespace rivulet::races {

struct Order {
    enum class Kind { backwards, interleaved, shuffled };
    Kind kind = Kind::backwards;
    uint32_t seed = 0;  // of `shuffled`: a pseudo-random permutation of the groups, and another one of the work items of each group

    // For a person, with what repeats it: "shuffled by RIVULET_ORDER_SEED=7".
    std::string name() const;
    // The item of `count` that is the k-th.
    uint32_t item(uint32_t k, uint32_t count) const;
};

// RIVULET_ORDER_SEED in the environment; else one of its own in each run with RIVULET_RACES=full, and always the same without.
Result<uint32_t> orderSeed();

// Shaders whose lang.h numbers work items and groups in that order. Error (failed): lang.h has other lines than this expects.
Result<ShaderFiles> shadersIn(const Order& order);

// What compilers may make of NaN: min, max and clamp that return their second operand if either is NaN (as x86 does), or NaN; and !(a < b)
// as a >= b, as Mesa's optimiser has it. Without NaN all are the same.
enum class NanHabit { second, spreads, inverts };
Result<ShaderFiles> shadersWith(NanHabit habit);

// A cpu whose kernels run one work item after the other in that order, on one thread. All such devices have the order of the
// last call.
std::unique_ptr<CpuDevice> cpuIn(const Order& order);

}  // namespace rivulet::races
