#include "engine/gpu/gl_object.h"

#include <rivulet_glad/gl.h>

namespace rivulet::gpu {

void deleteBuffer(unsigned name) { glDeleteBuffers(1, &name); }
void deleteTexture(unsigned name) { glDeleteTextures(1, &name); }
void deleteSampler(unsigned name) { glDeleteSamplers(1, &name); }
void deleteFramebuffer(unsigned name) { glDeleteFramebuffers(1, &name); }
void deleteVertexArray(unsigned name) { glDeleteVertexArrays(1, &name); }
void deleteQuery(unsigned name) { glDeleteQueries(1, &name); }
void deleteShader(unsigned name) { glDeleteShader(name); }
void deleteProgram(unsigned name) { glDeleteProgram(name); }

}  // namespace rivulet::gpu
