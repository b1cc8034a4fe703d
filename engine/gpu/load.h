// Loading OpenGL's functions, by whatever finds them: glfwGetProcAddress, SDL_GL_GetProcAddress, eglGetProcAddress.
#pragma once

#include "engine/core/result.h"

namespace rivulet::gpu {

using FunctionPointer = void (*)();
using FindFunction = FunctionPointer (*)(const char* name);

// Of the context that is current; once, before all else. The functions are the process's: contexts of one driver share them. Error
// (failed): no context, or none of OpenGL 4.5; says which it is.
Status load(FindFunction find);

bool loaded();  // whether OpenGL's functions can be called at all

// A compatibility context's glPixelTransferf, which no core header names; null where load() has not found it.
using PixelTransfer = void (*)(unsigned name, float value);
PixelTransfer pixelTransfer();

}  // namespace rivulet::gpu
