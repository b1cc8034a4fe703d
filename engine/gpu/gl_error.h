// What glGetError says, for the calls whose failure is no mistake of ours: allocations. Everything else is the debug callback's.
#pragma once

#include <rivulet_glad/gl.h>

namespace rivulet::gpu {

const char* glErrorName(GLenum error);  // "GL_OUT_OF_MEMORY"
GLenum takeGlError();                   // the oldest; the others are dropped
void forgetGlErrors();                  // so that the next one is ours: the debug callback has heard of them

}  // namespace rivulet::gpu
