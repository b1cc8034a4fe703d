#include "engine/ui/style.h"

#include <imgui.h>

#include <filesystem>

namespace rivulet {

void loadUiFont(float pixels) {
    ImGuiIO& io = ImGui::GetIO();
    io.Fonts->Clear();
    constexpr const char* kFont = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";  // package fonts-dejavu-core
    std::error_code ignored;
    if (std::filesystem::is_regular_file(kFont, ignored)) {
        io.Fonts->AddFontFromFileTTF(kFont, 14 * pixels);
        io.FontGlobalScale = 1 / pixels;
    }
    if (io.Fonts->Fonts.empty()) {  // ImGui's own has one size
        io.Fonts->AddFontDefault();
        io.FontGlobalScale = 1;
    }
}

void applyUiStyle() {
    loadUiFont(1);
    ImGui::StyleColorsDark();
    ImGuiStyle& style = ImGui::GetStyle();
    style.WindowRounding = 6;
    style.FrameRounding = 4;
    style.GrabRounding = 3;
    style.PopupRounding = 4;
    style.ScrollbarRounding = 6;
    style.WindowBorderSize = 0;
    style.WindowPadding = ImVec2(10, 10);
    style.FramePadding = ImVec2(6, 3);
    style.ItemSpacing = ImVec2(8, 5);
    style.IndentSpacing = 14;
    style.ScrollbarSize = 11;
    style.GrabMinSize = 9;
    style.WindowTitleAlign = ImVec2(0.5F, 0.5F);

    ImVec4* colour = style.Colors;
    auto set = [colour](std::initializer_list<ImGuiCol> which, float r, float g, float b, float a) {
        for (ImGuiCol index : which) colour[index] = ImVec4(r, g, b, a);
    };
    set({ImGuiCol_Text}, 0.90F, 0.93F, 0.95F, 1);
    set({ImGuiCol_TextDisabled}, 0.50F, 0.56F, 0.61F, 1);
    set({ImGuiCol_WindowBg, ImGuiCol_TitleBg, ImGuiCol_TitleBgActive, ImGuiCol_TitleBgCollapsed}, 0.07F, 0.09F, 0.11F, 0.90F);
    set({ImGuiCol_PopupBg}, 0.09F, 0.11F, 0.14F, 0.98F);
    set({ImGuiCol_FrameBg}, 0.15F, 0.19F, 0.23F, 0.90F);
    set({ImGuiCol_FrameBgHovered}, 0.19F, 0.25F, 0.30F, 1);
    set({ImGuiCol_FrameBgActive}, 0.21F, 0.29F, 0.35F, 1);
    set({ImGuiCol_Header}, 0.13F, 0.22F, 0.28F, 0.95F);
    set({ImGuiCol_HeaderHovered, ImGuiCol_ButtonHovered}, 0.17F, 0.33F, 0.42F, 1);
    set({ImGuiCol_HeaderActive, ImGuiCol_ButtonActive}, 0.18F, 0.42F, 0.54F, 1);
    set({ImGuiCol_Button}, 0.15F, 0.26F, 0.33F, 1);
    set({ImGuiCol_Tab, ImGuiCol_TabUnfocused}, 0.11F, 0.16F, 0.20F, 1);
    set({ImGuiCol_TabHovered}, 0.17F, 0.33F, 0.42F, 1);
    set({ImGuiCol_TabActive, ImGuiCol_TabUnfocusedActive}, 0.16F, 0.36F, 0.46F, 1);
    set({ImGuiCol_SliderGrab, ImGuiCol_CheckMark, ImGuiCol_PlotHistogram}, 0.27F, 0.66F, 0.84F, 1);
    set({ImGuiCol_SliderGrabActive}, 0.42F, 0.78F, 0.94F, 1);
    set({ImGuiCol_ScrollbarBg}, 0, 0, 0, 0);
    set({ImGuiCol_ScrollbarGrab}, 0.24F, 0.30F, 0.35F, 0.8F);
    set({ImGuiCol_Separator}, 0.22F, 0.27F, 0.32F, 0.8F);
}

}  // namespace rivulet
