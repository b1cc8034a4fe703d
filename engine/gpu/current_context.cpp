#include "engine/gpu/current_context.h"

#if defined(_WIN32)
#include <windows.h>
#else
#include <dlfcn.h>
#endif
#include <rivulet_glad/gl.h>

#include "engine/gpu/buffer.h"

namespace rivulet::gpu {
namespace {

using Current = void* (*)();

// Calls `name` of `library` if the process has loaded that library, else returns null: only a loaded library can have created a context.
#if defined(_WIN32)
void* ask(const char* library, const char* name) {
    const HMODULE loaded = GetModuleHandleA(library);
    const auto current = loaded ? reinterpret_cast<Current>(reinterpret_cast<void*>(GetProcAddress(loaded, name))) : nullptr;
    return current ? current() : nullptr;
}
#else
void* ask(const char* library, const char* name) {
    void* loaded = dlopen(library, RTLD_LAZY | RTLD_NOLOAD);
    if (!loaded) return nullptr;
    const auto current = reinterpret_cast<Current>(dlsym(loaded, name));
    void* answer = current ? current() : nullptr;
    dlclose(loaded);
    return answer;
}
#endif

unsigned createBuffer(size_t bytes) {
    Result<Buffer> made = Buffer::create(bytes);
    return made ? made->release() : 0;
}

void writeBuffer(unsigned buffer, std::span<const std::byte> bytes) {
    glNamedBufferSubData(buffer, 0, static_cast<GLsizeiptr>(bytes.size()), bytes.data());
}

void readBuffer(unsigned buffer, std::span<std::byte> bytes) {
    glGetNamedBufferSubData(buffer, 0, static_cast<GLsizeiptr>(bytes.size()), bytes.data());
}

void finish() { glFinish(); }

}  // namespace

GlContext currentContext() {
    GlContext gl{.create = createBuffer, .write = writeBuffer, .read = readBuffer, .destroy = deleteBuffer, .finish = finish};
#if defined(_WIN32)
    gl.egl = false;
    gl.context = ask("opengl32.dll", "wglGetCurrentContext");
    gl.display = gl.context ? ask("opengl32.dll", "wglGetCurrentDC") : nullptr;
#else
    gl.context = ask("libEGL.so.1", "eglGetCurrentContext");
    if (gl.context) {
        gl.display = ask("libEGL.so.1", "eglGetCurrentDisplay");
        return gl;
    }
    gl.egl = false;  // libGL has the GLX functions if there is no libGLX
    for (const char* library : {"libGLX.so.0", "libGL.so.1"}) {
        gl.context = ask(library, "glXGetCurrentContext");
        gl.display = gl.context ? ask(library, "glXGetCurrentDisplay") : nullptr;
        if (gl.context) break;
    }
#endif
    return gl;
}

}  // namespace rivulet::gpu
