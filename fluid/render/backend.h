// Backends: the Device that simulates, by --backend, by what the machine has, and by what `auto` chooses.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "engine/compute/device_cpu.h"
#include "engine/core/log.h"
#include "engine/core/table.h"

namespace rivulet {

struct BackendRow {
    const char* name;  // the value of --backend
    const char* doc;
};
Table<BackendRow> backends();  // auto, cpu, gl, cl

// The current OpenGL context; `absent` says why there is none.
struct GlFacts {
    std::string absent = "no OpenGL context was requested";  // empty: there is a context
    std::string renderer, version;
    bool software = false;  // it runs on the CPU: llvmpipe, softpipe
    bool present() const { return absent.empty(); }
};
GlFacts currentGlFacts();              // of the context that is current on this thread
GlFacts noGl(const std::string& why);  // a sentence

struct BackendChoice {
    Backend backend = Backend::cpu;
    std::string why;  // half a sentence: "the OpenGL renderer llvmpipe is software"
};
// `wanted`: auto, cpu, gl or cl. gl only if `gl` is present. cl is not checked here; makeDevice does.
BackendChoice chooseBackend(std::string_view wanted, const GlFacts& gl);

// Resolves --backend and --device. An empty `backend` becomes `otherwise`, or cl if a device is given.
// Error (badInput): of checkIsa(); an unknown backend; a device for a backend other than cl; an OpenCL device that does not exist.
Status settleBackend(std::string& backend, const char* otherwise, const std::string& device);

// The wanted device; of cl the one that `clDevice` names (ClOptions::device). If it is absent, a cpu device is returned and `log` gets a
// notice; there is no Error. If `gl` is present, its context must be current and outlive the device: OpenCL shares memory with it where
// possible. `cpu`: of a cpu device.
std::unique_ptr<Device> makeDevice(std::string_view wanted, const GlFacts& gl, const Log& log, const std::string& clDevice = {},
                                   const CpuOptions& cpu = {});
std::unique_ptr<Device> makeCpu(const CpuOptions& options = {});

}  // namespace rivulet
