// Contexts: several headless ones exist together, windows deliver events, and a missing library gives an error message.
#include <backends/imgui_impl_glfw.h>
#include <imgui.h>
#include <rivulet_glad/gl.h>
#include <sys/wait.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <thread>
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include "engine/app/window_glfw.h"
#include "engine/gpu/buffer.h"
#include "tests/unit/gpu_context.h"

namespace rivulet::gpu_context_test {
namespace {

TEST(GpuContext, IsCoreAtLeast45AndCurrent) {
    Result<ContextEgl> context = ContextEgl::create();
    ASSERT_TRUE(context) << context.error().message;
    GLint major = 0, minor = 0, profile = 0;
    glGetIntegerv(GL_MAJOR_VERSION, &major);
    glGetIntegerv(GL_MINOR_VERSION, &minor);
    glGetIntegerv(GL_CONTEXT_PROFILE_MASK, &profile);
    EXPECT_GE(10 * major + minor, 45);
    EXPECT_EQ(profile, GL_CONTEXT_CORE_PROFILE_BIT);
    EXPECT_FALSE(context->renderer().empty());
    EXPECT_EQ(context->software(), context->renderer().find("pipe") != std::string::npos);
}

TEST(GpuContext, TwoAreIndependentAndOutliveEachOther) {
    Result<ContextEgl> first = ContextEgl::create();
    ASSERT_TRUE(first);
    {
        Result<gpu::Buffer> buffer = gpu::Buffer::create(16);
        ASSERT_TRUE(buffer);
        const GLuint name = buffer->name();
        {
            Result<ContextEgl> second = ContextEgl::create();
            ASSERT_TRUE(second);
            EXPECT_FALSE(glIsBuffer(name)) << "the new one is current and shares nothing";
            ContextEgl moved = std::move(*second);
            EXPECT_FALSE(moved.version().empty());
        }
        ASSERT_TRUE(first->makeCurrent());
        EXPECT_TRUE(glIsBuffer(name));
        std::thread([&] { EXPECT_FALSE(first->makeCurrent()) << "it is current elsewhere"; }).join();
    }
}

// In a process of its own, because EGL reads its drivers once.
TEST(GpuContextDeathTest, WithoutADriverIsASentence) {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    const auto tryWithout = [](const char* variable, const char* value) {
        setenv(variable, value, 1);
        const Result<ContextEgl> context = ContextEgl::create();
        std::fprintf(stderr, "%s", context ? "a context" : context.error().message.c_str());
        std::exit(context ? 0 : 3);
    };
    EXPECT_EXIT(tryWithout("__EGL_VENDOR_LIBRARY_FILENAMES", "/nonexistent"), ::testing::ExitedWithCode(3),
                "no OpenGL 4.5 without a window.*apt-get");
}

TEST(GpuContextDeathTest, AnOldOpenGlIsASentence) {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    if (!::testing::internal::InDeathTestChild()) {
        const Result<ContextEgl> here = ContextEgl::create();
        if (here && here->version().find("Mesa") == std::string::npos) GTEST_SKIP() << "only Mesa reads MESA_GL_VERSION_OVERRIDE";
    }
    const auto tryOld = [] {
        setenv("MESA_GL_VERSION_OVERRIDE", "3.3", 1);
        const Result<ContextEgl> context = ContextEgl::create();
        std::fprintf(stderr, "%s", context ? "a context" : context.error().message.c_str());
        std::exit(context ? 0 : 3);
    };
    EXPECT_EXIT(tryOld(), ::testing::ExitedWithCode(3), "no OpenGL 4.5");
}

// An X server for one test. 0: none is installed.
class Display {
  public:
    Display() {
        int ends[2];
        if (pipe(ends) != 0) return;
        server_ = fork();
        if (server_ == 0) {
            close(ends[0]);
            if (std::freopen("/dev/null", "w", stderr) == nullptr) std::_Exit(1);
            const std::string fd = std::to_string(ends[1]);
            execlp("Xvfb", "Xvfb", "-displayfd", fd.c_str(), "-screen", "0", "1024x768x24", "-nolisten", "tcp", nullptr);
            _exit(127);
        }
        close(ends[1]);
        char number[16] = {};
        for (size_t have = 0; have + 1 < sizeof number && ::read(ends[0], number + have, 1) == 1 && number[have] != '\n';) ++have;
        close(ends[0]);
        number[strcspn(number, "\n")] = '\0';
        if (number[0] == '\0') return;
        name_ = std::string(":") + number;
        setenv("DISPLAY", name_.c_str(), 1);
        unsetenv("WAYLAND_DISPLAY");
    }
    Display(const Display&) = delete;
    Display& operator=(const Display&) = delete;
    ~Display() {
        if (server_ <= 0) return;
        kill(server_, SIGTERM);
        waitpid(server_, nullptr, 0);
    }
    explicit operator bool() const { return !name_.empty(); }

  private:
    pid_t server_ = -1;
    std::string name_;
};

TEST(GpuWindow, WithoutADisplayIsASentence) {
    unsetenv("DISPLAY");
    unsetenv("WAYLAND_DISPLAY");
    const Result<WindowGlfw> window = WindowGlfw::create({});
    ASSERT_FALSE(window);
    EXPECT_NE(window.error().message.find("--headless"), std::string::npos) << window.error().message;
    EXPECT_EQ(window.error().fault, Fault::failed);
}

TEST(GpuWindow, HasItsSizeItsPixelsAndItsEvents) {
    const Display display;
    if (!display) GTEST_SKIP() << "Xvfb is not installed";
    Result<WindowGlfw> made = WindowGlfw::create({.title = "test", .width = 320, .height = 200, .debug = true});
    ASSERT_TRUE(made) << made.error().message;
    WindowGlfw window = std::move(*made);
    {
        gpu::DebugMessages messages{Log{}};
        EXPECT_EQ(window.poll().size, ivec2(320, 200));
        window.resize(400, 0);  // a window is never less than a pixel
        InputEvents events;
        for (int k = 0; k < 200 && events.size.x != 400; ++k) {
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
            events = window.poll();
        }
        EXPECT_EQ(events.size, ivec2(400, 1));
        EXPECT_EQ(events.framebuffer, ivec2(400, 1));
        EXPECT_FALSE(events.closed);

        glClearColor(0, 1, 0, 1);
        glClear(GL_COLOR_BUFFER_BIT);
        uint8_t pixel[4] = {};
        glReadPixels(0, 0, 1, 1, GL_RGBA, GL_UNSIGNED_BYTE, pixel);
        EXPECT_EQ(pixel[1], 255);
        window.swap();
        EXPECT_EQ(messages.errors(), 0) << messages.lastError();
    }

    // ImGui puts its callbacks in front of the window's: both must hear. What X would send is said by calling the first in the row.
    ImGui::CreateContext();
    ASSERT_TRUE(ImGui_ImplGlfw_InitForOpenGL(window.handle(), true));
    GLFWwindow* w = window.handle();
    const GLFWkeyfun key = glfwSetKeyCallback(w, nullptr);
    const GLFWcharfun text = glfwSetCharCallback(w, nullptr);
    const GLFWscrollfun scroll = glfwSetScrollCallback(w, nullptr);
    const GLFWmousebuttonfun button = glfwSetMouseButtonCallback(w, nullptr);
    const GLFWdropfun drop = glfwSetDropCallback(w, nullptr);
    ASSERT_TRUE(key && text && scroll && button && drop);
    key(w, GLFW_KEY_A, 0, GLFW_PRESS, 0);
    key(w, GLFW_KEY_A, 0, GLFW_REPEAT, 0);
    key(w, GLFW_KEY_B, 0, GLFW_PRESS, 0);
    key(w, GLFW_KEY_B, 0, GLFW_RELEASE, 0);
    key(w, GLFW_KEY_UNKNOWN, 0, GLFW_PRESS, 0);
    for (const unsigned code : {0x61U, 0xE4U, 0x6C34U, 0x1F30AU}) text(w, code);  // a, a umlaut, water, a wave
    scroll(w, 0, 1);
    scroll(w, 0.5, 2);
    button(w, GLFW_MOUSE_BUTTON_RIGHT, GLFW_PRESS, 0);
    button(w, GLFW_MOUSE_BUTTON_LEFT, GLFW_PRESS, 0);  // and up again, between two frames
    button(w, GLFW_MOUSE_BUTTON_LEFT, GLFW_RELEASE, 0);
    button(w, GLFW_MOUSE_BUTTON_8, GLFW_PRESS, 0);
    const char* paths[] = {"/a/scene.json", "/b.obj"};
    drop(w, 2, paths);

    ImGuiIO& io = ImGui::GetIO();
    io.IniFilename = nullptr;  // no file is written
    io.DisplaySize = ImVec2(400, 100);
    io.Fonts->Build();
#if IMGUI_VERSION_NUM >= 18700
    io.ConfigInputTrickleEventQueue = false;  // all events in the next frame
    ImGui::NewFrame();
    EXPECT_TRUE(ImGui::IsKeyDown(ImGuiKey_A));
#else
    ImGui::NewFrame();
    EXPECT_TRUE(io.KeysDown[GLFW_KEY_A]);
#endif
    EXPECT_EQ(io.MouseWheel, 3.0F);
    ImGui::EndFrame();
    InputEvents events = window.poll();
    EXPECT_EQ(events.keysPressed, (std::vector<int>{GLFW_KEY_A, GLFW_KEY_B}));
    EXPECT_TRUE(events.down(GLFW_KEY_A));
    EXPECT_FALSE(events.down(GLFW_KEY_B));
    EXPECT_EQ(events.text, "a\xC3\xA4\xE6\xB0\xB4\xF0\x9F\x8C\x8A");
    EXPECT_EQ(events.wheel, vec2(0.5F, 3.0F));
    EXPECT_TRUE(events.down(MouseButton::right) && events.pressed(MouseButton::right));
    EXPECT_TRUE(events.pressed(MouseButton::left) && events.down(MouseButton::left)) << "a click shorter than a frame is no less a click";
    events = window.poll();
    EXPECT_TRUE(events.buttonReleased[0] && !events.down(MouseButton::left));
    EXPECT_EQ(events.dropped, (std::vector<std::string>{"/a/scene.json", "/b.obj"}));

    events = window.poll();
    EXPECT_TRUE(events.keysPressed.empty() && events.text.empty() && events.dropped.empty());
    EXPECT_TRUE(events.down(GLFW_KEY_A) && events.down(MouseButton::right)) << "what is held stays held";
    EXPECT_FALSE(events.pressed(MouseButton::right));
    EXPECT_EQ(events.wheel, vec2(0));
    glfwSetWindowShouldClose(w, GLFW_TRUE);
    EXPECT_TRUE(window.poll().closed);
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
}

}  // namespace
}  // namespace rivulet::gpu_context_test
