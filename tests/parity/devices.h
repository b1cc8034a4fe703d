// The devices that a parity test compares, created by name. An absent device is an Error, which the test reports when it skips.
#pragma once

#include <memory>
#include <string>

#include "engine/compute/device.h"
#include "engine/compute/device_cl.h"
#include "engine/compute/device_cpu.h"
#include "engine/compute/kernel_source.h"
#include "engine/gpu/device_gl.h"
#include "fluid/sim/world/cpu_kernels.h"
#include "fluid/sim/world/fluid_world.h"
#include "fluid/validate/gpu_check.h"

namespace rivulet {

inline std::unique_ptr<Device> makeTestCpu(int threads = 0, Isa isa = bestIsa()) {
    const std::vector<CpuKernelRow> rows = cpuKernels();
    return makeCpuDevice(rows, {.threads = threads, .isa = isa});
}

// A GPU device and the context that must outlive it.
struct TestGpu {
    std::shared_ptr<void> context;  // gl: the OpenGL context
    std::unique_ptr<Device> device;
};
struct TestGpuOptions {
    ShaderFiles files = ShaderFiles::developer();
    GlOptions gl = {};
    ClOptions cl = {};
};
// "cl" or "gl". If RIVULET_TEST_DEVICES is set, as by tests/run.sh, an absent device fails the test.
Result<TestGpu> makeTestGpu(const std::string& name, const TestGpuOptions& options = {});

// Positions of the existing particles, m; waits for the device.
inline std::vector<vec3> positions(FluidWorld& world) {
    const ParticleView view = world.particles();
    std::vector<vec3> all;
    for (const vec4& x : world.device().readAll<vec4>(*view.position, view.count))
        if (!(x.w < 0)) all.emplace_back(x);
    return all;
}

// A dam break of 8,192 particles, see oneStepDam.
inline FluidParams parityDam(const char* method) {
    FluidParams p = oneStepDam(method, 0.03125F);
    p.cfl = 0.8F;
    return p;
}

}  // namespace rivulet
