#include "fluid/bridge/backend.h"

#include <fmt/format.h>
#include <glad/gl.h>

#include "engine/app/context_egl.h"
#include "engine/compute/device_cl.h"
#include "engine/compute/device_cpu.h"
#include "engine/compute/kernel_source.h"
#include "engine/gpu/device_gl.h"
#include "fluid/sim/cpu_kernels.h"

namespace rivulet {

Table<BackendRow> backends() {
    static constexpr BackendRow rows[] = {
        {"auto", "gl where OpenGL runs on a GPU, else cpu"},
        {"cpu", "all cores of the processor, 8 particles an instruction"},
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
    if (wanted == "cpu") return {Backend::cpu, "it was asked for"};
    if (wanted == "cl") return {Backend::cl, "it was asked for"};
    if (!gl.present()) return {Backend::cpu, gl.absent};
    if (wanted == "gl") return {Backend::gl, "it was asked for"};
    if (gl.software) return {Backend::cpu, fmt::format("the OpenGL renderer {} is software", gl.renderer)};
    return {Backend::gl, fmt::format("the OpenGL renderer {} is a GPU", gl.renderer)};
}

std::unique_ptr<Device> makeDevice(std::string_view wanted, const GlFacts& gl, const Log& log) {
    auto cpu = [] {
        std::vector<CpuKernelRow> rows = cpuKernels();
        return makeCpuDevice(rows);
    };
    BackendChoice choice = chooseBackend(wanted, gl);
    if (choice.backend == Backend::cpu) {
        if (wanted == "gl") log.notice(fmt::format("--backend gl: {}; the cpu simulates", choice.why));
        return cpu();
    }
    ShaderFiles files = ShaderFiles::developer();
    if (choice.backend == Backend::gl) return makeGlDevice(files, log);
    Result<std::unique_ptr<Device>> device = makeClDevice(files, log);
    if (device) return std::move(*device);
    log.notice(fmt::format("--backend {}: {}; the cpu simulates", wanted, device.error().message));
    return cpu();
}

}  // namespace rivulet
