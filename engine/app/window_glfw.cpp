#include "engine/app/window_glfw.h"

#define EGL_NO_X11
#include <EGL/egl.h>
#include <fmt/format.h>
#include <rivulet_glad/gl.h>
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <algorithm>
#include <map>
#include <mutex>
#include <utility>

#include "engine/app/input_queue.h"
#include "engine/core/assert.h"
#include "engine/gpu/device_gl.h"

namespace rivulet {
namespace {

static_assert(key::kEscape == GLFW_KEY_ESCAPE && key::kDelete == GLFW_KEY_DELETE && key::kRight == GLFW_KEY_RIGHT &&
              key::kUp == GLFW_KEY_UP && key::kEnd == GLFW_KEY_END && key::kF1 == GLFW_KEY_F1 && key::kLeftShift == GLFW_KEY_LEFT_SHIFT &&
              key::kRightAlt == GLFW_KEY_RIGHT_ALT && 'R' == GLFW_KEY_R && ' ' == GLFW_KEY_SPACE);

// UTF-8 of one code point.
std::string utf8Of(unsigned code) {
    std::string text;
    const auto put = [&](unsigned byte) { text += static_cast<char>(byte); };
    if (code < 0x80) {
        put(code);
    } else if (code < 0x800) {
        put(0xC0U | code >> 6U);
        put(0x80U | (code & 0x3FU));
    } else if (code < 0x10000) {
        put(0xE0U | code >> 12U);
        put(0x80U | (code >> 6U & 0x3FU));
        put(0x80U | (code & 0x3FU));
    } else {
        put(0xF0U | code >> 18U);
        put(0x80U | (code >> 12U & 0x3FU));
        put(0x80U | (code >> 6U & 0x3FU));
        put(0x80U | (code & 0x3FU));
    }
    return text;
}

std::string glfwTrouble() {
    const char* text = nullptr;
    glfwGetError(&text);
    return text ? text : "GLFW gives no reason";
}

}  // namespace

struct WindowGlfw::Impl {
    GLFWwindow* window = nullptr;
    InputQueue queue;         // what callbacks gathered
    InputEvents events;       // what is held
    std::map<int, int> keys;  // by GLFW's key: what it was when it went down
    bool hasMouse = false;
    std::string renderer;

    Impl() = default;
    Impl(const Impl&) = delete;
    Impl& operator=(const Impl&) = delete;
    ~Impl() {
        if (window) glfwDestroyWindow(window);
        glfwTerminate();
    }

    static InputQueue& of(GLFWwindow* window) { return static_cast<Impl*>(glfwGetWindowUserPointer(window))->queue; }

    // Set when the window is made: callbacks installed later (ImGui's) call these.
    void listen() {
        glfwSetWindowUserPointer(window, this);
        glfwSetCursorPosCallback(window,
                                 [](GLFWwindow* w, double x, double y) { of(w).move(vec2(static_cast<float>(x), static_cast<float>(y))); });
        glfwSetMouseButtonCallback(window, [](GLFWwindow* w, int button, int action, int) {
            if (button > GLFW_MOUSE_BUTTON_MIDDLE) return;  // left, right, middle: as in MouseButton
            of(w).button(static_cast<MouseButton>(button), action != GLFW_RELEASE);
        });
        glfwSetScrollCallback(window,
                              [](GLFWwindow* w, double x, double y) { of(w).wheel(vec2(static_cast<float>(x), static_cast<float>(y))); });
        glfwSetKeyCallback(window, [](GLFWwindow* w, int key, int scancode, int action, int) {
            if (key == GLFW_KEY_UNKNOWN || action == GLFW_REPEAT) return;
            auto& known = static_cast<Impl*>(glfwGetWindowUserPointer(w))->keys;
            if (action == GLFW_PRESS) known[key] = keyOf(key, glfwGetKeyName(key, scancode));
            const auto pressed = known.find(key);  // the keyboard may be another by now
            of(w).key(pressed != known.end() ? pressed->second : key, action == GLFW_PRESS);
        });
        glfwSetCharCallback(window, [](GLFWwindow* w, unsigned code) { of(w).type(utf8Of(code)); });
        glfwSetDropCallback(window, [](GLFWwindow* w, int count, const char** paths) {
            for (int k = 0; k < count; ++k) of(w).drop(paths[k]);
        });
    }
};

Result<WindowGlfw> WindowGlfw::create(const Options& options) {
    // Some drivers end the process when GLX meets a current EGL context.
    ASSERT(eglGetCurrentContext() == EGL_NO_CONTEXT, "destroy the ContextEgl before opening a window on its thread");
    if (glfwInit() != GLFW_TRUE)
        return failed(fmt::format("no window can be opened ({}); run with --headless, or start a display", glfwTrouble()));
    auto impl = std::make_unique<Impl>();  // from here on it ends GLFW
    glfwDefaultWindowHints();
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
    glfwWindowHint(GLFW_OPENGL_DEBUG_CONTEXT, options.debug ? GLFW_TRUE : GLFW_FALSE);
    glfwWindowHint(GLFW_VISIBLE, options.visible ? GLFW_TRUE : GLFW_FALSE);
    glfwWindowHint(GLFW_SCALE_TO_MONITOR, options.scaled ? GLFW_TRUE : GLFW_FALSE);
    // A context that notices when it is lost, if the driver has such.
    for (const int robustness : {GLFW_LOSE_CONTEXT_ON_RESET, GLFW_NO_ROBUSTNESS}) {
        glfwWindowHint(GLFW_CONTEXT_ROBUSTNESS, robustness);
        impl->window = glfwCreateWindow(std::max(options.width, 1), std::max(options.height, 1), options.title.c_str(), nullptr, nullptr);
        if (impl->window) break;
    }
    if (!impl->window)
        return failed(
            fmt::format("no window with OpenGL 4.5 can be opened ({}); run with --headless, or install a newer driver", glfwTrouble()));
    glfwMakeContextCurrent(impl->window);
    if (rivuletLoadGL(glfwGetProcAddress) == 0)
        return failed("the window's OpenGL driver lacks functions of 4.5; run with --headless, or install a newer driver");
    glfwSwapInterval(options.vsync ? 1 : 0);
    impl->renderer = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
    impl->listen();
    return WindowGlfw(std::move(impl));
}

WindowGlfw::WindowGlfw(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
WindowGlfw::WindowGlfw(WindowGlfw&&) noexcept = default;
WindowGlfw& WindowGlfw::operator=(WindowGlfw&& other) noexcept {
    std::swap(impl_, other.impl_);
    return *this;
}
WindowGlfw::~WindowGlfw() = default;

InputEvents WindowGlfw::poll() {
    glfwPollEvents();
    InputEvents& gathered = impl_->events;
    if (!impl_->hasMouse) {  // where it is before it has moved
        double x = 0, y = 0;
        glfwGetCursorPos(impl_->window, &x, &y);
        gathered.mouse = vec2(static_cast<float>(x), static_cast<float>(y));
        impl_->hasMouse = true;
    }
    impl_->queue.take(gathered);
    glfwGetWindowSize(impl_->window, &gathered.size.x, &gathered.size.y);
    glfwGetFramebufferSize(impl_->window, &gathered.framebuffer.x, &gathered.framebuffer.y);
    float across = 1, up = 1;
    glfwGetWindowContentScale(impl_->window, &across, &up);
    const float pixels = gathered.size.x > 0 ? static_cast<float>(gathered.framebuffer.x) / static_cast<float>(gathered.size.x) : 1.0F;
    gathered.scale = std::max(across / std::max(pixels, 0.1F), 0.5F);  // macOS has it in the pixels already, X11 and Windows do not
    // X11 keeps the size of a minimised window; Windows says 0.
    if (glfwGetWindowAttrib(impl_->window, GLFW_ICONIFIED) == GLFW_TRUE) gathered.size = gathered.framebuffer = ivec2(0);
    gathered.closed = glfwWindowShouldClose(impl_->window) == GLFW_TRUE;

    return gathered;
}

Result<SharedGl> WindowGlfw::shared() const {
    struct Second {
        GLFWwindow* window;
        std::mutex used;
        ~Second() { glfwDestroyWindow(window); }
    };
    glfwWindowHint(GLFW_VISIBLE, GLFW_FALSE);  // the others are those of the first
    GLFWwindow* window = glfwCreateWindow(1, 1, "", nullptr, impl_->window);
    if (window == nullptr) return failed(fmt::format("the driver cannot create a second OpenGL context ({})", glfwTrouble()));
    const std::shared_ptr<Second> second(new Second{window, {}});
    SharedGl shared;
    shared.enter = [s = second.get()] {
        s->used.lock();
        glfwMakeContextCurrent(s->window);
        if (glfwGetCurrentContext() == s->window) return true;
        s->used.unlock();
        return false;
    };
    shared.leave = [s = second.get()] {
        glfwMakeContextCurrent(nullptr);
        s->used.unlock();
    };
    shared.context = second;
    return shared;
}

void WindowGlfw::swap() { glfwSwapBuffers(impl_->window); }
void WindowGlfw::setTitle(const std::string& title) { glfwSetWindowTitle(impl_->window, title.c_str()); }
void WindowGlfw::resize(int width, int height) { glfwSetWindowSize(impl_->window, std::max(width, 1), std::max(height, 1)); }
GLFWwindow* WindowGlfw::handle() const { return impl_->window; }
bool WindowGlfw::software() const { return isSoftwareRenderer(impl_->renderer); }
const std::string& WindowGlfw::renderer() const { return impl_->renderer; }

}  // namespace rivulet
