// Device cl: kernels in OpenCL 1.2, on a GPU where there is one, else on whatever OpenCL offers (PoCL).
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
    // Which: its number in listClDevices(), from 1, or a part of its or its platform's name, letters of either case. "": the first.
    std::string device = {};
    std::string cache = cacheFolder("cl");  // where built programs are kept; "": nowhere
    GlContext gl = {};                      // whose buffers glShare() may copy into: outlives the device. None is current: nobody's
    // What tests let go wrong: the device has no more memory than this; it is lost once it has run so many dispatches; the dispatch after
    // so many is taken, and its event fails.
    size_t memoryLimit = SIZE_MAX;
    uint64_t failAfter = UINT64_MAX, eventFailsAfter = UINT64_MAX;
    const ClGlCalls* glCalls = nullptr;  // and what is taken for the driver's; null: the driver's
};

// Kernels are read through `files`. Errors: no OpenCL platform, no device that can compile kernels, no context (failed); none of the name
// that was asked for (badInput). `log` hears which one is taken where several have that name, and of trouble that comes later, where there
// is no Result to say it in: a dispatch that the driver refused. health() knows of it, too.
Result<std::unique_ptr<Device>> makeClDevice(const ShaderFiles& files, Log log = {}, const ClOptions& options = {});

struct ClDeviceListing {
    std::string name, platform;
    std::string sentence;  // these, and what it can
};
// The OpenCL devices of this machine, the one that makeClDevice takes first; empty where there is none.
std::vector<ClDeviceListing> listClDevices();
// Error (badInput): there are devices, and `wanted` (as ClOptions::device) is none of them.
Status checkClDevice(std::string_view wanted);

}  // namespace rivulet
