#include "tests/parity/devices.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "engine/app/context_egl.h"
#include "tests/expected_renderer.h"

namespace rivulet {

namespace {

Result<TestGpu> open(const std::string& name, const TestGpuOptions& options) {
    TestGpu gpu;
    if (name == "cl") {
        Result<std::unique_ptr<Device>> made = makeClDevice(options.files, {}, options.cl);
        if (!made) return made.error();
        gpu.device = std::move(*made);
        return gpu;
    }
    if (name == "gl") {
        Result<ContextEgl> context = ContextEgl::create();
        if (!context) return context.error();
        expectRenderer(context->renderer());
        gpu.context = std::make_shared<ContextEgl>(std::move(*context));
        gpu.device = makeGlDevice(options.files, {}, options.gl);
        return gpu;
    }
    return failed("no device is called " + name);
}

}  // namespace

Result<TestGpu> makeTestGpu(const std::string& name, const TestGpuOptions& options) {
    Result<TestGpu> gpu = open(name, options);
    if (!gpu && std::getenv("RIVULET_TEST_DEVICES") != nullptr)
        ADD_FAILURE() << name << " must be here, and is not: " << gpu.error().message;
    return gpu;
}

}  // namespace rivulet
