// OpenGL, whose functions a program finds by eglGetProcAddress().
#include <rivulet_glad/gl.h>

#include "tests/faults/interposer.h"
#include "tests/replaced_gl.h"

using namespace faults;

namespace {

thread_local GLenum pending = GL_NO_ERROR;  // of a call that failed, for glGetError()

// A lost context: commands have no effect.
bool lost() { return failed(kGlLost); }
bool losesBy(const void* caller) { return lost() || fails(kGlLost, caller); }

// The functions that are replaced, each with the driver's own beside it.
#define FAULTS_GL(result, name, ...)                         \
    result(GLAD_API_PTR* own_##name)(__VA_ARGS__) = nullptr; \
    result GLAD_API_PTR fail_##name(__VA_ARGS__)

FAULTS_GL(GLenum, glGetError, void) {
    if (lost()) return GL_CONTEXT_LOST;
    const GLenum error = pending;
    pending = GL_NO_ERROR;
    return error != GL_NO_ERROR ? error : own_glGetError();
}
FAULTS_GL(GLenum, glGetGraphicsResetStatus, void) { return lost() ? GL_GUILTY_CONTEXT_RESET : own_glGetGraphicsResetStatus(); }

bool lacksMemory(const void* caller) {
    if (lost()) return true;
    if (!fails(kGlMemory, caller)) return false;
    pending = GL_OUT_OF_MEMORY;
    return true;
}
FAULTS_GL(void, glNamedBufferStorage, GLuint buffer, GLsizeiptr bytes, const void* data, GLbitfield flags) {
    if (!lacksMemory(FAULTS_CALLER)) own_glNamedBufferStorage(buffer, bytes, data, flags);
}
FAULTS_GL(void, glTextureStorage2D, GLuint texture, GLsizei levels, GLenum format, GLsizei width, GLsizei height) {
    if (!lacksMemory(FAULTS_CALLER)) own_glTextureStorage2D(texture, levels, format, width, height);
}
FAULTS_GL(void, glTextureStorage3D, GLuint texture, GLsizei levels, GLenum format, GLsizei width, GLsizei height, GLsizei depth) {
    if (!lacksMemory(FAULTS_CALLER)) own_glTextureStorage3D(texture, levels, format, width, height, depth);
}
FAULTS_GL(void*, glMapNamedBufferRange, GLuint buffer, GLintptr offset, GLsizeiptr bytes, GLbitfield access) {
    if (lost()) return nullptr;
    if (!fails(kGlMap, FAULTS_CALLER)) return own_glMapNamedBufferRange(buffer, offset, bytes, access);
    pending = GL_OUT_OF_MEMORY;
    return nullptr;
}
FAULTS_GL(void, glGetShaderiv, GLuint shader, GLenum what, GLint* value) {
    own_glGetShaderiv(shader, what, value);
    if (what == GL_COMPILE_STATUS && fails(kGlProgram, FAULTS_CALLER)) *value = GL_FALSE;
}
FAULTS_GL(void, glGetProgramiv, GLuint program, GLenum what, GLint* value) {
    own_glGetProgramiv(program, what, value);
    if (what == GL_LINK_STATUS && fails(kGlProgram, FAULTS_CALLER)) *value = GL_FALSE;
}
FAULTS_GL(GLsync, glFenceSync, GLenum condition, GLbitfield flags) {
    return lost() || fails(kGlFence, FAULTS_CALLER) ? nullptr : own_glFenceSync(condition, flags);
}
FAULTS_GL(GLenum, glClientWaitSync, GLsync sync, GLbitfield flags, GLuint64 timeout) {
    return lost() ? GL_WAIT_FAILED : own_glClientWaitSync(sync, flags, timeout);
}
FAULTS_GL(GLenum, glCheckNamedFramebufferStatus, GLuint framebuffer, GLenum target) {
    if (lost()) return 0;
    if (!fails(kGlTarget, FAULTS_CALLER)) return own_glCheckNamedFramebufferStatus(framebuffer, target);
    pending = GL_OUT_OF_MEMORY;
    return GL_FRAMEBUFFER_UNSUPPORTED;
}
FAULTS_GL(void, glDispatchCompute, GLuint x, GLuint y, GLuint z) {
    if (!losesBy(FAULTS_CALLER)) own_glDispatchCompute(x, y, z);
}
FAULTS_GL(void, glDrawArrays, GLenum mode, GLint first, GLsizei count) {
    if (!losesBy(FAULTS_CALLER)) own_glDrawArrays(mode, first, count);
}
FAULTS_GL(void, glDrawArraysInstanced, GLenum mode, GLint first, GLsizei count, GLsizei instances) {
    if (!losesBy(FAULTS_CALLER)) own_glDrawArraysInstanced(mode, first, count, instances);
}
FAULTS_GL(void, glDrawElements, GLenum mode, GLsizei count, GLenum type, const void* indices) {
    if (!losesBy(FAULTS_CALLER)) own_glDrawElements(mode, count, type, indices);
}
FAULTS_GL(void, glDrawElementsInstanced, GLenum mode, GLsizei count, GLenum type, const void* indices, GLsizei instances) {
    if (!losesBy(FAULTS_CALLER)) own_glDrawElementsInstanced(mode, count, type, indices, instances);
}
FAULTS_GL(void, glGetNamedBufferSubData, GLuint buffer, GLintptr offset, GLsizeiptr bytes, void* data) {
    if (!lost()) own_glGetNamedBufferSubData(buffer, offset, bytes, data);
}
FAULTS_GL(void, glGetTextureSubImage, GLuint texture, GLint level, GLint x, GLint y, GLint z, GLsizei width, GLsizei height, GLsizei depth,
          GLenum format, GLenum type, GLsizei bytes, void* pixels) {
    if (!lost()) own_glGetTextureSubImage(texture, level, x, y, z, width, height, depth, format, type, bytes, pixels);
}

const rivulet::testing::ReplacedGl rows[] = {
    REPLACED_GL(fail, glGetError),
    REPLACED_GL(fail, glGetGraphicsResetStatus),
    REPLACED_GL(fail, glNamedBufferStorage),
    REPLACED_GL(fail, glTextureStorage2D),
    REPLACED_GL(fail, glTextureStorage3D),
    REPLACED_GL(fail, glMapNamedBufferRange),
    REPLACED_GL(fail, glGetShaderiv),
    REPLACED_GL(fail, glGetProgramiv),
    REPLACED_GL(fail, glFenceSync),
    REPLACED_GL(fail, glClientWaitSync),
    REPLACED_GL(fail, glCheckNamedFramebufferStatus),
    REPLACED_GL(fail, glDispatchCompute),
    REPLACED_GL(fail, glDrawArrays),
    REPLACED_GL(fail, glDrawArraysInstanced),
    REPLACED_GL(fail, glDrawElements),
    REPLACED_GL(fail, glDrawElementsInstanced),
    REPLACED_GL(fail, glGetNamedBufferSubData),
    REPLACED_GL(fail, glGetTextureSubImage),
};

}  // namespace

extern "C" rivulet::testing::GlFunction eglGetProcAddress(const char* name) {
    return rivulet::testing::replaced(rows, name, FAULTS_NEXT(eglGetProcAddress)(name));
}
