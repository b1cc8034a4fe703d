#include "engine/gpu/load.h"

#include <fmt/format.h>
#include <rivulet_glad/gl.h>

#include <atomic>
#include <mutex>

namespace rivulet::gpu {

namespace {

std::atomic<PixelTransfer> foundPixelTransfer = nullptr;

}  // namespace

bool loaded() { return glGetString != nullptr; }

PixelTransfer pixelTransfer() { return foundPixelTransfer; }

Status load(FindFunction find) {
    if (find == nullptr) return badInput("the function that finds OpenGL's functions is null; pass for example glfwGetProcAddress");
    using GetString = const GLubyte*(GLAD_API_PTR*)(GLenum);
    const auto getString = reinterpret_cast<GetString>(find("glGetString"));
    const auto* version = getString != nullptr ? reinterpret_cast<const char*>(getString(GL_VERSION)) : nullptr;
    if (getString == nullptr)
        return badInput(
            "the function that finds OpenGL's functions does not find glGetString; pass that of the library that created the context");
    if (version == nullptr) return failed("no OpenGL context is current on this thread; make one current first");
    // Several threads may call this, each with its own context. Function pointers that a thread may be using are not written again.
    static std::mutex one;
    static FindFunction last = nullptr;
    const std::scoped_lock lock(one);
    int got = 0;
    if (last == find) {
        GLint major = 0, minor = 0;
        glGetIntegerv(GL_MAJOR_VERSION, &major);
        glGetIntegerv(GL_MINOR_VERSION, &minor);
        got = GLAD_MAKE_VERSION(major, minor);
    } else {
        got = rivuletLoadGL(find);
        if (got >= GLAD_MAKE_VERSION(4, 5)) last = find;
        foundPixelTransfer = reinterpret_cast<PixelTransfer>(find("glPixelTransferf"));
    }
    if (got < GLAD_MAKE_VERSION(4, 5))
        return failed(fmt::format(
            "OpenGL 4.5 is needed, but this context has OpenGL {}; update the graphics driver or create a context of version 4.5",
            version));
    return ok();
}

}  // namespace rivulet::gpu
