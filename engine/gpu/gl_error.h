// glGetError, for calls that may fail in a correct program: allocations. All other errors are reported by the debug callback.
#pragma once

#include <rivulet_glad/gl.h>

namespace rivulet::gpu {

const char* glErrorName(GLenum error);  // "GL_OUT_OF_MEMORY"
GLenum takeGlError();                   // the oldest pending error; the others are dropped
void clearGlErrors();                   // drops all pending errors, which the debug callback has reported already

}  // namespace rivulet::gpu
