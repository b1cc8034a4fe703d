#include "engine/gpu/gl_error.h"

namespace rivulet::gpu {

const char* glErrorName(GLenum error) {
    switch (error) {
        case GL_NO_ERROR:
            return "GL_NO_ERROR";
        case GL_OUT_OF_MEMORY:
            return "GL_OUT_OF_MEMORY";
        case GL_INVALID_ENUM:
            return "GL_INVALID_ENUM";
        case GL_INVALID_VALUE:
            return "GL_INVALID_VALUE";
        case GL_INVALID_OPERATION:
            return "GL_INVALID_OPERATION";
        case GL_INVALID_FRAMEBUFFER_OPERATION:
            return "GL_INVALID_FRAMEBUFFER_OPERATION";
        default:
            return "an unknown GL error";
    }
}

GLenum takeGlError() {
    const GLenum first = glGetError();
    if (first != GL_NO_ERROR) clearGlErrors();
    return first;
}

void clearGlErrors() {
    // A lost context returns an error in every call, so the loop is bounded.
    for (int k = 0; k < 16 && glGetError() != GL_NO_ERROR; ++k) {
    }
}

// The reset status is reported once; GL_CONTEXT_LOST is returned by every later call.
bool contextLost() { return glGetGraphicsResetStatus() != GL_NO_ERROR || glGetError() == GL_CONTEXT_LOST; }

}  // namespace rivulet::gpu
