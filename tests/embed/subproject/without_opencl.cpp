// A library that was built without OpenCL says so, and the cpu simulates.
#include <cstdio>

#include "rivulet/fluid/render/backend.h"

using namespace rivulet;

int main() {
    std::string said;
    const Log log{[&](LogLevel, std::string_view text) { said += text; }};
    const std::unique_ptr<Device> device = makeDevice("cl", noGl("there is no window"), log);
    std::printf("%s\n", said.c_str());
    return device->backend() == Backend::cpu && said.find("was built without OpenCL") != std::string::npos ? 0 : 1;
}
