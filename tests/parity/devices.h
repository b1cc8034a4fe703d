// The devices a parity test compares: each by name, made anew; an absent one is an Error that the test reports when it skips.
#pragma once

#include <memory>
#include <string>

#include "engine/compute/device.h"
#include "engine/compute/device_cl.h"
#include "engine/compute/device_cpu.h"
#include "engine/compute/kernel_source.h"
#include "fluid/sim/cpu_kernels.h"

namespace rivulet {

inline std::unique_ptr<Device> makeTestCpu(int threads = 0, Isa isa = bestIsa()) {
    const std::vector<CpuKernelRow> rows = cpuKernels();
    return makeCpuDevice(rows, {.threads = threads, .isa = isa});
}

// A GPU device with what must outlive it.
struct TestGpu {
    std::shared_ptr<void> context;  // gl: the OpenGL context
    std::unique_ptr<Device> device;
};
Result<TestGpu> makeTestGpu(const std::string& name);  // "cl" or "gl"

}  // namespace rivulet
