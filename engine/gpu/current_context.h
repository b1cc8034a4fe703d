// The OpenGL context that is current on this thread, as the handles that OpenCL needs to share buffers with it.
#pragma once

#include "engine/compute/gl_sharing.h"

namespace rivulet::gpu {

// Call its functions only while the context is current and OpenGL's functions are loaded. `context` is null if neither EGL nor GLX has a
// current context on this thread.
GlContext currentContext();

}  // namespace rivulet::gpu
