#include "tests/parity/devices.h"

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
    return failed("no device is called " + name);
}

}  // namespace rivulet
