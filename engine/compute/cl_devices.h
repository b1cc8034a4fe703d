// The OpenCL devices of this machine and their properties. Only for device_cl*.cpp and cl_*.cpp, because it includes OpenCL.
#pragma once

#include <CL/cl.h>

#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/log.h"
#include "engine/core/result.h"

namespace rivulet {

// "CL_OUT_OF_RESOURCES"; for a code without a name here: "OpenCL error -1001".
std::string clErrorName(cl_int code);

// A text from clGet*Info, without the white space that some drivers put around it.
template <class Get>
std::string clText(Get get) {
    constexpr const char* kBlank = " \n\r\t";
    size_t size = 0;
    if (get(size_t{0}, nullptr, &size) != CL_SUCCESS || size == 0) return {};
    std::string text(size, '\0');
    if (get(size, text.data(), nullptr) != CL_SUCCESS) return {};
    text.resize(std::strlen(text.c_str()));
    const size_t first = text.find_first_not_of(kBlank);
    return first == std::string::npos ? std::string() : text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}
std::string clDeviceText(cl_device_id device, cl_device_info what);
std::string clPlatformText(cl_platform_id platform, cl_platform_info what);

template <class T>
T clDeviceValue(cl_device_id device, cl_device_info what) {
    T value{};
    clGetDeviceInfo(device, what, sizeof value, &value, nullptr);
    return value;
}

struct ClCandidate {
    cl_platform_id platform;
    cl_device_id device;
    cl_device_type type;
    bool usable;  // available, little-endian, with a compiler and OpenCL 1.2
    std::string name, platformName;
};

// All devices, the best first: usable GPUs, other usable ones, the rest. `platforms` receives the number of drivers found.
std::vector<ClCandidate> findClDevices(size_t& platforms);

// The devices of `all` that match `wanted` (as ClOptions::device). Error (badInput): none; the message lists all devices.
Result<std::vector<ClCandidate>> namedClDevices(const std::vector<ClCandidate>& all, std::string_view wanted);

}  // namespace rivulet
