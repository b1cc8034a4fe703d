#include "engine/app/ui_layer.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "engine/ui/style.h"

namespace rivulet {

struct UiLayer::Impl {
    ImGuiContext* context = nullptr;
    bool drawing = false;  // the backend was set up
    float pixels = 1;      // a coordinate, that the font was made for

    ~Impl() {
        if (context == nullptr) return;
        ImGui::SetCurrentContext(context);
        if (drawing) ImGui_ImplOpenGL3_Shutdown();
        ImGui::DestroyContext(context);
    }
};

UiLayer::UiLayer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
UiLayer::UiLayer(UiLayer&&) noexcept = default;
UiLayer& UiLayer::operator=(UiLayer&&) noexcept = default;
UiLayer::~UiLayer() = default;

namespace {

// Pairs of key codes: Dear ImGui's, GLFW's.
constexpr std::pair<int, int> kKeys[] = {{ImGuiKey_Tab, GLFW_KEY_TAB},
                                         {ImGuiKey_LeftArrow, GLFW_KEY_LEFT},
                                         {ImGuiKey_RightArrow, GLFW_KEY_RIGHT},
                                         {ImGuiKey_UpArrow, GLFW_KEY_UP},
                                         {ImGuiKey_DownArrow, GLFW_KEY_DOWN},
                                         {ImGuiKey_PageUp, GLFW_KEY_PAGE_UP},
                                         {ImGuiKey_PageDown, GLFW_KEY_PAGE_DOWN},
                                         {ImGuiKey_Home, GLFW_KEY_HOME},
                                         {ImGuiKey_End, GLFW_KEY_END},
                                         {ImGuiKey_Insert, GLFW_KEY_INSERT},
                                         {ImGuiKey_Delete, GLFW_KEY_DELETE},
                                         {ImGuiKey_Backspace, GLFW_KEY_BACKSPACE},
                                         {ImGuiKey_Space, GLFW_KEY_SPACE},
                                         {ImGuiKey_Enter, GLFW_KEY_ENTER},
                                         {ImGuiKey_Escape, GLFW_KEY_ESCAPE},
                                         {ImGuiKey_A, GLFW_KEY_A},
                                         {ImGuiKey_C, GLFW_KEY_C},
                                         {ImGuiKey_V, GLFW_KEY_V},
                                         {ImGuiKey_X, GLFW_KEY_X},
                                         {ImGuiKey_Y, GLFW_KEY_Y},
                                         {ImGuiKey_Z, GLFW_KEY_Z}};

// Passes the keys that are down in this frame to Dear ImGui: as events from version 1.89 on, in tables before.
void setKeys(ImGuiIO& io, const std::vector<int>& down) {
    const auto isDown = [&down](int key) { return std::find(down.begin(), down.end(), key) != down.end(); };
    const bool control = isDown(GLFW_KEY_LEFT_CONTROL) || isDown(GLFW_KEY_RIGHT_CONTROL);
    const bool shift = isDown(GLFW_KEY_LEFT_SHIFT) || isDown(GLFW_KEY_RIGHT_SHIFT);
    const bool alt = isDown(GLFW_KEY_LEFT_ALT) || isDown(GLFW_KEY_RIGHT_ALT);
    const bool super = isDown(GLFW_KEY_LEFT_SUPER) || isDown(GLFW_KEY_RIGHT_SUPER);
#if IMGUI_VERSION_NUM >= 18900
    for (const auto& [to, from] : kKeys) io.AddKeyEvent(static_cast<ImGuiKey>(to), isDown(from));
    io.AddKeyEvent(ImGuiKey_KeypadEnter, isDown(GLFW_KEY_KP_ENTER));
    io.AddKeyEvent(ImGuiMod_Ctrl, control);
    io.AddKeyEvent(ImGuiMod_Shift, shift);
    io.AddKeyEvent(ImGuiMod_Alt, alt);
    io.AddKeyEvent(ImGuiMod_Super, super);
#else
    for (const auto& [to, from] : kKeys) {
        io.KeyMap[to] = from;
        io.KeysDown[from] = isDown(from);
    }
    io.KeyMap[ImGuiKey_KeyPadEnter] = GLFW_KEY_KP_ENTER;
    io.KeysDown[GLFW_KEY_KP_ENTER] = isDown(GLFW_KEY_KP_ENTER);
    io.KeyCtrl = control;
    io.KeyShift = shift;
    io.KeyAlt = alt;
    io.KeySuper = super;
#endif
}

}  // namespace

Result<UiLayer> UiLayer::create(void* clipboard) {
    auto impl = std::make_unique<Impl>();
    impl->context = ImGui::CreateContext();
    ImGui::SetCurrentContext(impl->context);
    ImGuiIO& io = ImGui::GetIO();
    io.IniFilename = nullptr;  // nothing is written behind the person's back
    io.LogFilename = nullptr;
    io.ConfigWindowsMoveFromTitleBarOnly = true;  // or a drag beside a slider would move its window
#if IMGUI_VERSION_NUM >= 18900
    io.ConfigInputTrickleEventQueue = false;  // all keys of a frame act in that frame
#endif
    if (clipboard != nullptr) {
        io.ClipboardUserData = clipboard;
        io.GetClipboardTextFn = [](void* window) { return glfwGetClipboardString(static_cast<GLFWwindow*>(window)); };
        io.SetClipboardTextFn = [](void* window, const char* text) { glfwSetClipboardString(static_cast<GLFWwindow*>(window), text); };
    }
    applyUiStyle();
    impl->drawing = ImGui_ImplOpenGL3_Init("#version 450 core");
    if (!impl->drawing) return failed("the user interface could not be set up: the OpenGL driver refuses it");
    return UiLayer(std::move(impl));
}

void UiLayer::begin(const InputEvents& input, double seconds) {
    ImGui::SetCurrentContext(impl_->context);
    ImGuiIO& io = ImGui::GetIO();
    // ImGui's coordinates are those of an ordinary screen, so that panels do not depend on other scales.
    const float scale = std::clamp(input.scale, 0.25F, 8.0F);
    io.DisplaySize = ImVec2(static_cast<float>(std::max(input.size.x, 0)) / scale, static_cast<float>(std::max(input.size.y, 0)) / scale);
    if (input.size.x > 0 && input.size.y > 0) {
        io.DisplayFramebufferScale =
            ImVec2(static_cast<float>(input.framebuffer.x) / io.DisplaySize.x, static_cast<float>(input.framebuffer.y) / io.DisplaySize.y);
        const float pixels = std::clamp(std::round(4 * io.DisplayFramebufferScale.y) / 4, 0.5F, 8.0F);
        if (input.framebuffer.y > 0 && pixels != impl_->pixels) {
            impl_->pixels = pixels;
            loadUiFont(pixels);
            ImGui_ImplOpenGL3_DestroyFontsTexture();
            ImGui_ImplOpenGL3_CreateFontsTexture();
        }
    }
    io.DeltaTime = static_cast<float>(std::clamp(seconds, 1e-4, 0.25));

    io.MousePos = ImVec2(input.mouse.x / scale, input.mouse.y / scale);
    constexpr MouseButton kButtons[] = {MouseButton::left, MouseButton::right, MouseButton::middle};
    for (int i = 0; i < 3; ++i)
        io.MouseDown[i] = input.down(kButtons[i]) || input.pressed(kButtons[i]);  // a click within a frame counts too
    io.MouseWheelH = input.wheel.x;
    io.MouseWheel = input.wheel.y;

    std::vector<int> down = input.keysDown;
    down.insert(down.end(), input.keysPressed.begin(), input.keysPressed.end());  // a key pressed and released within a frame counts too
    setKeys(io, down);
    io.AddInputCharactersUTF8(input.text.c_str());

    ImGui_ImplOpenGL3_NewFrame();
    ImGui::NewFrame();
}

void UiLayer::draw() {
    ImGui::SetCurrentContext(impl_->context);
    ImGui::Render();
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

bool UiLayer::wantsMouse() const {
    ImGui::SetCurrentContext(impl_->context);
    return ImGui::GetIO().WantCaptureMouse;
}

bool UiLayer::wantsKeyboard() const {
    ImGui::SetCurrentContext(impl_->context);
    return ImGui::GetIO().WantTextInput;
}

}  // namespace rivulet
