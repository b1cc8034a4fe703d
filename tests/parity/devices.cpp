#include "tests/parity/devices.h"

#include "engine/app/context_egl.h"
#include "engine/gpu/device_gl.h"

namespace rivulet {

Result<TestGpu> makeTestGpu(const std::string& name) {
    const ShaderFiles files = ShaderFiles::developer();
    TestGpu gpu;
    if (name == "cl") {
        Result<std::unique_ptr<Device>> made = makeClDevice(files);
        if (!made) return made.error();
        gpu.device = std::move(*made);
        return gpu;
    }
    if (name == "gl") {
        Result<ContextEgl> context = ContextEgl::create();
        if (!context) return context.error();
        gpu.context = std::make_shared<ContextEgl>(std::move(*context));
        gpu.device = makeGlDevice(files);
        return gpu;
    }
    return failed("no device is called " + name);
}

}  // namespace rivulet
