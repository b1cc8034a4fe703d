// Whether a device computes and draws the same water as the cpu: a subset of the parity tests for a user's machine.
#pragma once

#include <string>
#include <vector>

#include "engine/compute/device.h"
#include "engine/core/result.h"
#include "fluid/sim/world/fluid_world.h"

namespace rivulet {

struct GpuFinding {
    std::string device;     // "gl"
    std::string what;       // "pbf: largest difference of positions after 10 steps"
    std::string unit;       // "spacings"
    double difference = 0;  // in that unit
    double limit = 0;
    std::string error = {};                                               // why the device could not do it; empty: it could
    bool passed() const { return error.empty() && difference <= limit; }  // NaN does not pass
    std::string sentence() const;  // "gl: pbf: largest difference of positions after 10 steps: 3.1 spacings; at most 0.01 is allowed"
};

// A dam break with particles `spacing` m apart in which a frame of 1/1600 s is one step on every device, for any method.
FluidParams oneStepDam(const char* method, float spacing);

// Steps small worlds on both: one for each method, one with all forces, bodies in contact in water, and drops on a skin. What fails, for
// example because a kernel does not compile, has GpuFinding::error, and the next is tried unless the device is lost. When hostSeconds() is
// past `until`, those that have not been done are named in `leftOut`; the first that does not fail always is done.
std::vector<GpuFinding> checkDevice(Device& device, Device& cpu, double until, std::vector<std::string>& leftOut);

// Draws water with the context that is current: the share of pixels that the water changes, against that of its particles projected on the
// CPU. Error (failed): a shader does not compile, or out of GPU memory.
Result<GpuFinding> checkPicture(FluidWorld& world);

}  // namespace rivulet
