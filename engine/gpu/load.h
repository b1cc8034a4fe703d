// Loads OpenGL's functions with glfwGetProcAddress, SDL_GL_GetProcAddress, eglGetProcAddress or a similar function.
#pragma once

#include "engine/core/result.h"

namespace rivulet::gpu {

using FunctionPointer = void (*)();
using FindFunction = FunctionPointer (*)(const char* name);

// Loads the functions of the current context. Call it once, before everything else. The function pointers are global to the process:
// contexts of one driver share them. Error (badInput): `find` is null or finds nothing; (failed): no current context, or one older than
// OpenGL 4.5, with its version.
Status load(FindFunction find);

bool loaded();  // whether OpenGL's functions can be called

// glPixelTransferf of a compatibility context, which the core profile's header does not declare; null if load() did not find it.
using PixelTransfer = void (*)(unsigned name, float value);
PixelTransfer pixelTransfer();

}  // namespace rivulet::gpu
