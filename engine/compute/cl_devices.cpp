#include "engine/compute/cl_devices.h"

#include <CL/cl_gl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>

#include "engine/compute/device_cl.h"

namespace rivulet {

namespace {

const char* typeName(cl_device_type type) {
    if (type & CL_DEVICE_TYPE_GPU) return "GPU";
    if (type & CL_DEVICE_TYPE_CPU) return "CPU";
    return "accelerator";
}

std::string lower(std::string_view text) {
    std::string small(text);
    for (char& c : small) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return small;
}

}  // namespace

std::string clErrorName(cl_int code) {
    switch (code) {
        case CL_DEVICE_NOT_FOUND:
            return "CL_DEVICE_NOT_FOUND";
        case CL_DEVICE_NOT_AVAILABLE:
            return "CL_DEVICE_NOT_AVAILABLE";
        case CL_COMPILER_NOT_AVAILABLE:
            return "CL_COMPILER_NOT_AVAILABLE";
        case CL_MEM_OBJECT_ALLOCATION_FAILURE:
            return "CL_MEM_OBJECT_ALLOCATION_FAILURE";
        case CL_OUT_OF_RESOURCES:
            return "CL_OUT_OF_RESOURCES";
        case CL_OUT_OF_HOST_MEMORY:
            return "CL_OUT_OF_HOST_MEMORY";
        case CL_BUILD_PROGRAM_FAILURE:
            return "CL_BUILD_PROGRAM_FAILURE";
        case CL_EXEC_STATUS_ERROR_FOR_EVENTS_IN_WAIT_LIST:
            return "CL_EXEC_STATUS_ERROR_FOR_EVENTS_IN_WAIT_LIST";
        case CL_INVALID_CONTEXT:
            return "CL_INVALID_CONTEXT";
        case CL_INVALID_COMMAND_QUEUE:
            return "CL_INVALID_COMMAND_QUEUE";
        case CL_INVALID_BUFFER_SIZE:
            return "CL_INVALID_BUFFER_SIZE";
        case CL_INVALID_KERNEL_ARGS:
            return "CL_INVALID_KERNEL_ARGS";
        case CL_INVALID_WORK_GROUP_SIZE:
            return "CL_INVALID_WORK_GROUP_SIZE";
        case CL_INVALID_PROPERTY:
            return "CL_INVALID_PROPERTY";
        case CL_INVALID_OPERATION:
            return "CL_INVALID_OPERATION";
        case CL_INVALID_GL_OBJECT:
            return "CL_INVALID_GL_OBJECT";
        case CL_INVALID_GL_SHAREGROUP_REFERENCE_KHR:
            return "CL_INVALID_GL_SHAREGROUP_REFERENCE_KHR";
        default:
            return fmt::format("OpenCL error {}", code);
    }
}

std::string clDeviceText(cl_device_id device, cl_device_info what) {
    return clText([&](size_t size, void* to, size_t* needed) { return clGetDeviceInfo(device, what, size, to, needed); });
}
std::string clPlatformText(cl_platform_id platform, cl_platform_info what) {
    return clText([&](size_t size, void* to, size_t* needed) { return clGetPlatformInfo(platform, what, size, to, needed); });
}

std::vector<ClCandidate> findClDevices(size_t& platforms) {
    // The loader skips a driver file that names a missing library. Without another driver the call fails, which also means no platform.
    cl_uint count = 0;
    platforms = 0;
    if (clGetPlatformIDs(0, nullptr, &count) != CL_SUCCESS || count == 0) return {};
    std::vector<cl_platform_id> platformIds(count);
    if (clGetPlatformIDs(count, platformIds.data(), nullptr) != CL_SUCCESS) return {};
    platforms = count;
    std::vector<ClCandidate> found;
    for (const cl_platform_id platform : platformIds) {
        cl_uint devices = 0;
        if (clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 0, nullptr, &devices) != CL_SUCCESS || devices == 0) continue;
        std::vector<cl_device_id> ids(devices);
        if (clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, devices, ids.data(), nullptr) != CL_SUCCESS) continue;
        for (const cl_device_id id : ids) {
            const std::string version = clDeviceText(id, CL_DEVICE_VERSION);
            const bool usable = clDeviceValue<cl_bool>(id, CL_DEVICE_AVAILABLE) &&
                                clDeviceValue<cl_bool>(id, CL_DEVICE_COMPILER_AVAILABLE) &&
                                clDeviceValue<cl_bool>(id, CL_DEVICE_ENDIAN_LITTLE) && !version.starts_with("OpenCL 1.0") &&
                                !version.starts_with("OpenCL 1.1");
            found.push_back({platform, id, clDeviceValue<cl_device_type>(id, CL_DEVICE_TYPE), usable, clDeviceText(id, CL_DEVICE_NAME),
                             clPlatformText(platform, CL_PLATFORM_NAME)});
        }
    }
    const auto rank = [](const ClCandidate& c) { return !c.usable ? 2 : (c.type & CL_DEVICE_TYPE_GPU) ? 0 : 1; };
    std::stable_sort(found.begin(), found.end(), [&](const ClCandidate& a, const ClCandidate& b) { return rank(a) < rank(b); });
    return found;
}

Result<std::vector<ClCandidate>> namedClDevices(const std::vector<ClCandidate>& all, std::string_view wanted) {
    if (wanted.empty()) return all;
    std::vector<std::string> listed;
    for (size_t k = 0; k < all.size(); ++k) {
        const std::string number = std::to_string(k + 1);
        if (wanted == number) return std::vector<ClCandidate>{all[k]};
        listed.push_back(fmt::format("{} {} ({})", number, all[k].name, all[k].platformName));
    }
    std::vector<ClCandidate> fits;
    for (const ClCandidate& c : all)
        if (lower(c.name).find(lower(wanted)) != std::string::npos || lower(c.platformName).find(lower(wanted)) != std::string::npos)
            fits.push_back(c);
    if (!fits.empty()) return fits;
    return badInput(fmt::format("no OpenCL device matches '{}'; use one of: {}", wanted, fmt::join(listed, ", ")));
}

std::vector<ClDeviceListing> listClDevices() {
    size_t platforms = 0;
    std::vector<ClDeviceListing> listings;
    for (const ClCandidate& c : findClDevices(platforms))
        listings.push_back({c.name, c.platformName,
                            fmt::format("{} ({}, {} compute units, {} MiB, buffers up to {} MiB; {}, {}; driver {}){}", c.name,
                                        typeName(c.type), clDeviceValue<cl_uint>(c.device, CL_DEVICE_MAX_COMPUTE_UNITS),
                                        clDeviceValue<cl_ulong>(c.device, CL_DEVICE_GLOBAL_MEM_SIZE) >> 20U,
                                        clDeviceValue<cl_ulong>(c.device, CL_DEVICE_MAX_MEM_ALLOC_SIZE) >> 20U, c.platformName,
                                        clPlatformText(c.platform, CL_PLATFORM_VERSION), clDeviceText(c.device, CL_DRIVER_VERSION),
                                        c.usable ? "" : ", which cannot run kernels here")});
    return listings;
}

Status checkClDevice(std::string_view wanted) {
    size_t platforms = 0;
    const std::vector<ClCandidate> all = findClDevices(platforms);
    if (all.empty()) return ok();  // makeClDevice reports that there is no device
    const auto fits = namedClDevices(all, wanted);
    return fits ? ok() : Status(fits.error());
}

}  // namespace rivulet
