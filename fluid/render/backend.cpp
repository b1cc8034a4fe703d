#include "fluid/render/backend.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <rivulet_glad/gl.h>

#include <algorithm>

#include "engine/compute/device_cl.h"
#include "engine/compute/kernel_source.h"
#include "engine/gpu/current_context.h"
#include "engine/gpu/device_gl.h"
#include "engine/gpu/load.h"
#include "fluid/sim/world/cpu_kernels.h"

namespace rivulet {

Table<BackendRow> backends() {
    static constexpr BackendRow rows[] = {
        {"auto", "gl if OpenGL runs on a GPU, else cpu"},
        {"cpu", "all cores of the processor, 8 particles per instruction"},
        {"gl", "OpenGL 4.5 compute shaders"},
        {"cl", "OpenCL 1.2"},
    };
    return {rows};
}

GlFacts currentGlFacts() {
    auto text = [](GLenum name) {
        const GLubyte* value = glGetString(name);
        return std::string(value == nullptr ? "unknown" : reinterpret_cast<const char*>(value));
    };
    if (!gpu::loaded()) return noGl("OpenGL's functions are not loaded: rivulet::gpu::load comes first");
    GlFacts facts;
    facts.absent.clear();
    facts.renderer = text(GL_RENDERER);
    facts.version = text(GL_VERSION);
    facts.software = isSoftwareRenderer(facts.renderer);
    return facts;
}

GlFacts noGl(const std::string& why) {
    GlFacts facts;
    facts.absent = why;
    return facts;
}

BackendChoice chooseBackend(std::string_view wanted, const GlFacts& gl) {
    if (wanted == "cpu") return {Backend::cpu, "it was requested"};
    if (wanted == "cl") return {Backend::cl, "it was requested"};
    if (!gl.present()) return {Backend::cpu, gl.absent};
    if (wanted == "gl") return {Backend::gl, "it was requested"};
    if (gl.software) return {Backend::cpu, fmt::format("the OpenGL renderer {} is software", gl.renderer)};
    return {Backend::gl, fmt::format("the OpenGL renderer {} is a GPU", gl.renderer)};
}

Status settleBackend(std::string& backend, const char* otherwise, const std::string& device) {
    if (Status isa = checkIsa(); !isa) return isa;
    if (backend.empty()) backend = device.empty() ? otherwise : "cl";
    const std::vector<std::string> names = backends().names();
    if (std::find(names.begin(), names.end(), backend) == names.end()) {
        const std::string near = nearestName(backend, names);
        return badInput(near.empty() ? fmt::format("unknown backend '{}'; choose one of {}", backend, fmt::join(names, ", "))
                                     : fmt::format("unknown backend '{}'; did you mean '{}'?", backend, near));
    }
    if (device.empty()) return ok();
    if (backend == "auto") backend = "cl";
    if (backend != "cl")
        return badInput(
            fmt::format("--device selects an OpenCL device, but --backend is {}; leave out one of the two, or use --backend cl", backend));
    return checkClDevice(device);
}

std::unique_ptr<Device> makeCpu(const CpuOptions& options) {
    const std::vector<CpuKernelRow> rows = cpuKernels();
    return makeCpuDevice(rows, options);
}

std::unique_ptr<Device> makeDevice(std::string_view wanted, const GlFacts& gl, const Log& log, const std::string& clDevice,
                                   const CpuOptions& cpu) {
    BackendChoice choice = chooseBackend(wanted, gl);
    if (choice.backend == Backend::cpu) {
        if (wanted == "gl") log.notice(fmt::format("--backend gl: {}; the cpu simulates", choice.why));
        return makeCpu(cpu);
    }
    ShaderFiles files = ShaderFiles::developer();
    if (choice.backend == Backend::gl) return makeGlDevice(files, log);
    Result<std::unique_ptr<Device>> device =
        makeClDevice(files, log, {.device = clDevice, .gl = gl.present() ? gpu::currentContext() : GlContext{}});
    if (device) return std::move(*device);
    log.notice(fmt::format("--backend {}: {}; the cpu simulates", wanted, device.error().message));
    return makeCpu(cpu);
}

}  // namespace rivulet
