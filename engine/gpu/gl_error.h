// glGetError, for calls that may fail in a correct program: allocations. All other errors are reported by the debug callback.
#pragma once

#include <rivulet_glad/gl.h>

namespace rivulet::gpu {

const char* glErrorName(GLenum error);  // "GL_OUT_OF_MEMORY"
GLenum takeGlError();                   // the oldest pending error; the others are dropped
void clearGlErrors();                   // drops all pending errors, which the debug callback has reported already

// Whether the current context is lost: the driver has restarted, or the GPU is gone. Commands then do nothing, and what is read is not
// written. Only contexts that were created with a notification of resets know it. May take one pending error.
bool contextLost();
// The sentence for it.
inline constexpr const char* kContextLost = "the OpenGL context is lost: the driver was restarted, or the GPU was removed";

}  // namespace rivulet::gpu
