// Device gl: kernels as OpenGL 4.5 compute shaders.
#pragma once

#include <memory>
#include <string_view>

#include "engine/compute/device.h"
#include "engine/compute/kernel_source.h"
#include "engine/core/log.h"

namespace rivulet {

// Needs a current OpenGL 4.5 context, now and in every call, with its functions loaded (ContextEgl and WindowGlfw do it). Kernels are read
// through `files`; work groups of 64 unless the define LOCAL_SIZE says otherwise. Binding 0 of GL_UNIFORM_BUFFER and 1..n of
// GL_SHADER_STORAGE_BUFFER, and the program in use, are changed by dispatch(). `log` hears of trouble that no Result can carry.
// A Buffer's handle() is a GL buffer name: it may be drawn from (attributes, elements, SSBO, uniform, indirect) without further barriers.
std::unique_ptr<Device> makeGlDevice(const ShaderFiles& files, Log log = {});

// `gl` was used with another context so far, with which the one that is current now shares its objects: what is not shared is made anew,
// and figures that have not come yet never will.
void contextChanged(Device& gl);

// True for a GL_RENDERER that runs on the CPU: Mesa's llvmpipe, softpipe, swrast.
bool isSoftwareRenderer(std::string_view renderer);

}  // namespace rivulet
