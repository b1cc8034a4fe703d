// Which Device simulates, and why: what --backend asks for, what the machine has, what auto chooses.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "engine/compute/device.h"
#include "engine/core/log.h"
#include "engine/core/table.h"

namespace rivulet {

struct BackendRow {
    const char* name;  // as --backend takes it
    const char* doc;
};
Table<BackendRow> backends();  // auto, cpu, gl, cl

// What the current OpenGL context is; `absent` when there is none.
struct GlFacts {
    std::string absent = "no OpenGL context was asked for";  // why there is none; empty: there is one
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
// `wanted`: auto, cpu, gl or cl. gl only where `gl` is present; cl as asked, makeDevice finds out.
BackendChoice chooseBackend(std::string_view wanted, const GlFacts& gl);

// What --backend and --device ask for together; `backend` "" where it was not given, and is `otherwise` then. A device alone asks for cl.
// Error (badInput): an unknown backend; a device of one that has none to choose among; an OpenCL device that is not there.
Status settleBackend(std::string& backend, const char* otherwise, const std::string& device);

// The device that was asked for, of cl that which `clDevice` names (ClOptions::device). One that is absent: a notice in `log`, and a cpu
// device. Error: none at all, the cpu's cannot fail. Where `gl` is present, its context must be current and outlive the device: OpenCL
// shares memory with it if it can.
std::unique_ptr<Device> makeDevice(std::string_view wanted, const GlFacts& gl, const Log& log, const std::string& clDevice = {});
std::unique_ptr<Device> makeCpu();  // on all cores

}  // namespace rivulet
