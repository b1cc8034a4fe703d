// Worlds on the cpu for physics tests.
#pragma once

#include <gtest/gtest.h>

#include <memory>

#include "engine/compute/device_cpu.h"
#include "fluid/sim/world/cpu_kernels.h"
#include "fluid/sim/world/fluid_world.h"

namespace rivulet {

inline std::unique_ptr<CpuDevice> cpu() {
    const std::vector<CpuKernelRow> rows = cpuKernels();
    return makeCpuDevice(rows);
}

inline std::unique_ptr<FluidWorld> makeWorld(Device& device, const FluidParams& params, const Solids& solids = {}) {
    auto world = FluidWorld::create(device, params, solids, {});
    EXPECT_TRUE(world) << (world ? "" : world.error().message);
    return world ? std::move(*world) : nullptr;
}

}  // namespace rivulet
