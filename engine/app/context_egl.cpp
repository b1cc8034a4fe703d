#include "engine/app/context_egl.h"

#define EGL_NO_X11
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <fmt/format.h>
#include <rivulet_glad/gl.h>

#include <initializer_list>
#include <mutex>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/core/extension_list.h"
#include "engine/gpu/device_gl.h"

namespace rivulet {
namespace {

// `list` is null where EGL has none.
bool offers(const char* list, std::string_view extension) { return hasExtension(list ? list : "", extension); }

template <class Function>
Function entryPoint(const char* name) {
    return reinterpret_cast<Function>(eglGetProcAddress(name));
}

struct Candidate {
    EGLDisplay display;
    const char* platform;
};

// Displays in the order in which they are tried. `hardwareOnly`: leave out those that can only be the CPU.
std::vector<Candidate> findDisplays(bool hardwareOnly) {
    std::vector<Candidate> found;
    const char* extensions = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    const auto getDisplay = entryPoint<PFNEGLGETPLATFORMDISPLAYEXTPROC>("eglGetPlatformDisplayEXT");
    const auto add = [&](EGLDisplay display, const char* platform) {
        if (display != EGL_NO_DISPLAY) found.push_back({display, platform});
    };
    if (getDisplay && !hardwareOnly && offers(extensions, "EGL_MESA_platform_surfaceless"))
        add(getDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr), "surfaceless");
    const auto queryDevices = entryPoint<PFNEGLQUERYDEVICESEXTPROC>("eglQueryDevicesEXT");
    const auto queryDevice = entryPoint<PFNEGLQUERYDEVICESTRINGEXTPROC>("eglQueryDeviceStringEXT");
    EGLint count = 0;
    if (getDisplay && queryDevices && queryDevice && offers(extensions, "EGL_EXT_platform_device") &&
        queryDevices(0, nullptr, &count) == EGL_TRUE && count > 0) {
        std::vector<EGLDeviceEXT> devices(static_cast<size_t>(count));
        queryDevices(count, devices.data(), &count);
        devices.resize(static_cast<size_t>(count));
        for (EGLDeviceEXT device : devices)
            if (!hardwareOnly || !offers(queryDevice(device, EGL_EXTENSIONS), "EGL_MESA_device_software"))
                add(getDisplay(EGL_PLATFORM_DEVICE_EXT, device, nullptr), "device");
    }
    if (!hardwareOnly) add(eglGetDisplay(EGL_DEFAULT_DISPLAY), "default");
    return found;
}

}  // namespace

struct ContextEgl::Impl {
    EGLDisplay display = EGL_NO_DISPLAY;
    EGLContext context = EGL_NO_CONTEXT;
    EGLConfig config = EGL_NO_CONFIG_KHR;
    Options options;
    const char* platform = "";
    std::string renderer, version;

    Impl() = default;
    Impl(const Impl&) = delete;
    Impl& operator=(const Impl&) = delete;
    // The display stays open: EGL shares it within the process, and closing it would end the contexts of others.
    ~Impl() {
        if (context == EGL_NO_CONTEXT) return;
        if (eglGetCurrentContext() == context) eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        eglDestroyContext(display, context);
    }

    // One that notices when it is lost, if the driver has such.
    EGLContext make(EGLContext shares) const {
        const EGLContext notices = make(shares, {EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY, EGL_LOSE_CONTEXT_ON_RESET});
        return notices != EGL_NO_CONTEXT ? notices : make(shares, {});
    }

    EGLContext make(EGLContext shares, std::initializer_list<EGLint> more) const {
        std::vector<EGLint> attributes = {
            EGL_CONTEXT_MAJOR_VERSION,
            4,
            EGL_CONTEXT_MINOR_VERSION,
            5,
            EGL_CONTEXT_OPENGL_PROFILE_MASK,
            options.compatibility ? EGL_CONTEXT_OPENGL_COMPATIBILITY_PROFILE_BIT : EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
            EGL_CONTEXT_OPENGL_DEBUG,
            options.debug ? EGL_TRUE : EGL_FALSE};
        attributes.insert(attributes.end(), more);
        attributes.push_back(EGL_NONE);
        return eglCreateContext(display, config, shares, attributes.data());
    }

    // Returns nullptr if this display offers no OpenGL 4.5 core context without a surface; `why` then gives the reason.
    static std::unique_ptr<Impl> open(const Candidate& candidate, const Options& options, std::string& why) {
        EGLint major = 0, minor = 0;
        if (eglInitialize(candidate.display, &major, &minor) != EGL_TRUE) {
            why = fmt::format("EGL's {} display cannot be initialised", candidate.platform);
            return nullptr;
        }
        const char* extensions = eglQueryString(candidate.display, EGL_EXTENSIONS);
        if (!offers(extensions, "EGL_KHR_surfaceless_context") || eglBindAPI(EGL_OPENGL_API) != EGL_TRUE) {
            why = fmt::format("EGL's {} display has no OpenGL without a surface", candidate.platform);
            return nullptr;
        }
        EGLConfig config = EGL_NO_CONFIG_KHR;
        EGLint configs = 0;
        const EGLint wanted[] = {EGL_SURFACE_TYPE, 0, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
        if (!offers(extensions, "EGL_KHR_no_config_context") &&
            (eglChooseConfig(candidate.display, wanted, &config, 1, &configs) != EGL_TRUE || configs == 0)) {
            why = fmt::format("EGL's {} display has no configuration for OpenGL", candidate.platform);
            return nullptr;
        }
        auto impl = std::make_unique<Impl>();
        impl->display = candidate.display;
        impl->platform = candidate.platform;
        impl->config = config;
        impl->options = options;
        impl->context = impl->make(EGL_NO_CONTEXT);
        if (impl->context == EGL_NO_CONTEXT ||
            eglMakeCurrent(candidate.display, EGL_NO_SURFACE, EGL_NO_SURFACE, impl->context) != EGL_TRUE ||
            rivuletLoadGL(eglGetProcAddress) == 0) {
            why = fmt::format("EGL's {} display offers no OpenGL 4.5 core context (EGL error {:#x})", candidate.platform, eglGetError());
            return nullptr;
        }
        impl->renderer = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
        impl->version = reinterpret_cast<const char*>(glGetString(GL_VERSION));
        return impl;
    }
};

Result<ContextEgl> ContextEgl::create(const Options& options) {
    std::string why;  // of the first: it was the most likely one
    std::unique_ptr<Impl> best;
    for (const Candidate& candidate : findDisplays(false)) {
        std::string here;
        best = Impl::open(candidate, options, here);
        if (best) break;
        if (why.empty()) why = here;
    }
    if (why.empty()) why = "EGL lists no display";
    // Beside a software renderer, a GPU may hide behind another driver.
    if (best && isSoftwareRenderer(best->renderer))
        for (const Candidate& candidate : findDisplays(true)) {
            std::unique_ptr<Impl> other = Impl::open(candidate, options, why);
            if (!other || isSoftwareRenderer(other->renderer)) continue;
            best = std::move(other);
            break;
        }
    if (!best)
        return failed(
            fmt::format("this machine offers no OpenGL 4.5 without a window ({}); install a driver (on Debian: apt-get install "
                        "libegl-mesa0 libgl1-mesa-dri)",
                        why));
    ContextEgl context(std::move(best));
    const Status current = context.makeCurrent();
    if (!current) return current.error();
    return context;
}

ContextEgl::ContextEgl(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
ContextEgl::ContextEgl(ContextEgl&&) noexcept = default;
ContextEgl& ContextEgl::operator=(ContextEgl&&) noexcept = default;
ContextEgl::~ContextEgl() = default;

Status ContextEgl::makeCurrent() {
    if (eglMakeCurrent(impl_->display, EGL_NO_SURFACE, EGL_NO_SURFACE, impl_->context) != EGL_TRUE)
        return failed(
            fmt::format("the OpenGL context cannot be used here (EGL error {:#x}); is it current on another thread?", eglGetError()));
    rivuletLoadGL(eglGetProcAddress);
    return ok();
}

Result<SharedGl> ContextEgl::shared() const {
    struct Second {
        EGLDisplay display;
        EGLContext context;
        std::mutex used;
        ~Second() { eglDestroyContext(display, context); }
    };
    const EGLContext context = impl_->make(impl_->context);
    if (context == EGL_NO_CONTEXT)
        return failed(fmt::format("the driver cannot create a second OpenGL context (EGL error {:#x})", eglGetError()));
    const std::shared_ptr<Second> second(new Second{impl_->display, context, {}});
    SharedGl shared;
    shared.enter = [s = second.get()] {
        s->used.lock();
        if (eglBindAPI(EGL_OPENGL_API) == EGL_TRUE && eglMakeCurrent(s->display, EGL_NO_SURFACE, EGL_NO_SURFACE, s->context) == EGL_TRUE)
            return true;
        s->used.unlock();
        return false;
    };
    shared.leave = [s = second.get()] {
        eglMakeCurrent(s->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        s->used.unlock();
    };
    shared.context = second;
    return shared;
}

bool ContextEgl::software() const { return isSoftwareRenderer(impl_->renderer); }
const std::string& ContextEgl::renderer() const { return impl_->renderer; }
const std::string& ContextEgl::version() const { return impl_->version; }
const char* ContextEgl::platform() const { return impl_->platform; }

}  // namespace rivulet
