#include "fluid/viewer/save_dialog.h"

#include <imgui.h>
#include <imgui_stdlib.h>

#include <cstdlib>
#include <filesystem>

#include "engine/core/message_line.h"
#include "engine/ui/style.h"
#include "fluid/viewer/screen_capture.h"

namespace rivulet {

std::string fullPath(const std::string& typed) {
    const char* home = std::getenv("HOME");
    const bool own = home != nullptr && (typed == "~" || typed.starts_with("~/"));
    return own ? home + typed.substr(1) : typed;
}

std::optional<std::string> SaveDialog::draw(const SceneFile& scene) {
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    if (path_.empty()) path_ = fileName(scene.name) + ".json";
    ImGui::SetNextWindowPos(ImVec2(display.x / 2, display.y / 2), ImGuiCond_Appearing, ImVec2(0.5F, 0.5F));
    ImGui::Begin("save the scene", &shown_, ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_AlwaysAutoResize);
    ImGui::SetNextItemWidth(ImGui::GetFontSize() * 28);
    if (ImGui::IsWindowAppearing()) trouble_.clear();
    if (ImGui::IsWindowAppearing() || refocus_) ImGui::SetKeyboardFocusHere();
    refocus_ = false;
    const bool entered = ImGui::InputText("##path", &path_, ImGuiInputTextFlags_EnterReturnsTrue);
    if (ImGui::IsItemEdited()) trouble_.clear();
    std::string path = fullPath(path_);
    if (!path.empty() && std::filesystem::path(path).extension() != ".json") path += ".json";  // by which a scene is known
    std::error_code error;
    const bool there = std::filesystem::exists(path, error);
    const bool pressed = ImGui::Button(there ? "overwrite###write" : "save###write");
    ImGui::SameLine();
    if (ImGui::Button("cancel")) shown_ = false;
    if (there) {
        ImGui::SameLine();
        ImGui::TextDisabled("this file exists");
    }
    if (!trouble_.empty()) {
        ImGui::PushTextWrapPos(ImGui::GetFontSize() * 28);
        ImGui::TextColored(refusedColour(), "%s", trouble_.c_str());
        ImGui::PopTextWrapPos();
    }
    ImGui::End();
    if (entered && there) refocus_ = true;
    // Enter alone does not write over a file.
    if (!(pressed || (entered && !there)) || path_.empty()) return std::nullopt;
    SceneFile written = scene;
    if (Status saved = saveScene(written, path); !saved) {
        trouble_ = messageLine(saved.error().message);
        refocus_ = true;
        return std::nullopt;
    }
    path_ = path;
    shown_ = false;
    return path;
}

}  // namespace rivulet
