// The OpenGL context that is current on this thread, in the words that others share memory with it by.
#pragma once

#include "engine/compute/gl_sharing.h"

namespace rivulet::gpu {

// Its functions need it to be current, with OpenGL's loaded. `context` is null where neither EGL nor GLX has one on this thread.
GlContext currentContext();

}  // namespace rivulet::gpu
