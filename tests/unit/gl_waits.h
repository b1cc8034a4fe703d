// The calls of OpenGL that wait for the GPU, counted, for a library that looks its functions up with waitsFind().
#pragma once

#include <cstddef>
#include <map>
#include <string>

#include "engine/gpu/load.h"

namespace rivulet::testing {

// As countingFind() of engine/app/gl_count.h.
gpu::FunctionPointer waitsFind(const char* name);

void startGlWaits();
// Since then, by name; only those that were called: calls that return after the GPU has finished what they ask for, glClientWaitSync with
// a time, a buffer's glMapNamedBufferRange without GL_MAP_UNSYNCHRONIZED_BIT, and the result of a query that is not known to be available.
// A buffer that has just got its memory is mapped without a wait.
std::map<std::string, size_t> glWaits();

}  // namespace rivulet::testing
