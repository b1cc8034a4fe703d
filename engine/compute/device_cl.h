// Device cl: kernels in OpenCL 1.2, on a GPU if there is one, else on another OpenCL device (for example PoCL on the CPU).
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "engine/compute/device.h"
#include "engine/compute/disk_cache.h"
#include "engine/compute/gl_sharing.h"
#include "engine/compute/kernel_source.h"
#include "engine/core/log.h"

namespace rivulet {

struct ClGlCalls;  // cl_sharing.h

struct ClOptions {
    // The device: its number in listClDevices(), from 1, or part of its or its platform's name, ignoring case. "": the first.
    std::string device = {};
    std::string cache = cacheFolder("cl");  // folder of compiled programs; "": they are not stored
    GlContext gl = {};                      // the context that glShare() copies into; it must outlive the device. Default: no sharing
    // For tests of failures: memory of the device, bytes; number of dispatches after which the device is lost; number of dispatches after
    // which one is accepted but its event fails.
    size_t memoryLimit = SIZE_MAX;
    uint64_t failAfter = UINT64_MAX, eventFailsAfter = UINT64_MAX;
    // For tests of smaller devices: threads of a work group, unless a kernel's define LOCAL_SIZE sets another number; bytes of a buffer.
    uint32_t localSize = 64;
    size_t mostBufferBytes = SIZE_MAX;
    const ClGlCalls* glCalls = nullptr;  // for tests: replaces the driver's functions; null: the driver's
};

// Kernels are read through `files`. Error: no OpenCL platform, no device that can compile kernels, or no context (failed); no device of the
// requested name (badInput). `log` receives which device is used if several match, and later failures of calls that return no Result, for
// example a dispatch that the driver refused; health() reports these too.
Result<std::unique_ptr<Device>> makeClDevice(const ShaderFiles& files, Log log = {}, const ClOptions& options = {});

struct ClDeviceListing {
    std::string name, platform;
    std::string sentence;  // name, platform, type, memory and versions, for lists
};
// The OpenCL devices of this machine, in the order in which makeClDevice prefers them; empty if there are none.
std::vector<ClDeviceListing> listClDevices();
// Error (badInput): there are devices, and none matches `wanted` (as ClOptions::device).
Status checkClDevice(std::string_view wanted);

}  // namespace rivulet
