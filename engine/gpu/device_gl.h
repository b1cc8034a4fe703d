// Device gl: kernels as OpenGL 4.5 compute shaders.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string_view>

#include "engine/compute/device.h"
#include "engine/compute/kernel_source.h"
#include "engine/core/log.h"

namespace rivulet {

// For tests of smaller devices: each makes a limit of the context smaller. OpenGL guarantees 8 storage buffers of a kernel, 65535 groups of
// a dispatch, and buffers of 128 MiB.
struct GlOptions {
    uint32_t localSize = 64;  // threads of a work group, unless a kernel's define LOCAL_SIZE sets another number
    size_t mostBindings = SIZE_MAX;
    size_t mostGroups = SIZE_MAX;
    size_t mostBufferBytes = SIZE_MAX;
};

// Needs a current OpenGL 4.5 context, at creation and in every call, with its functions loaded (ContextEgl and WindowGlfw do this). Kernels
// are read through `files`. dispatch() changes binding 0 of GL_UNIFORM_BUFFER, bindings from 0 on of GL_SHADER_STORAGE_BUFFER and the
// program in use. `log` receives failures of calls that return no Result. A Buffer's handle() is a GL buffer name; it may be used for
// drawing (attributes, elements, SSBO, uniform, indirect) without further barriers.
std::unique_ptr<Device> makeGlDevice(const ShaderFiles& files, Log log = {}, const GlOptions& options = {});

// Call this after `gl` was used with another context that shares objects with the present one. Objects that contexts do not share are
// created again; times that have not arrived yet are lost.
void contextChanged(Device& gl);

// True for a GL_RENDERER that runs on the CPU: Mesa's llvmpipe, softpipe, swrast.
bool isSoftwareRenderer(std::string_view renderer);

}  // namespace rivulet
