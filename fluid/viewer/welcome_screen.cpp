// WelcomeScreen: a quiet sheet over the picture; a file that can hold nothing but one line.
#include "fluid/viewer/welcome_screen.h"

#include <imgui.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <utility>

#include "engine/core/file.h"

namespace rivulet {

namespace fs = std::filesystem;

namespace {

constexpr std::pair<const char*, const char*> kGestures[] = {{"drag", "rotate the view; with the right button, pan"},
                                                             {"wheel", "zoom"},
                                                             {"space", "pause or resume"},
                                                             {"O", "choose another scene"},
                                                             {"H", "show all keys"}};
constexpr const char* kTries[] = {"Press P, then hold the left button to pour; P again stops.",
                                  "Search for liquid in the left panel and choose another: oil, honey, blood.",
                                  "Drop a mesh file (.obj, .gltf, .fbx) onto the window: water flows over it.",
                                  "Press O and choose crying: tears on a face; click the skin to add one."};
const ImVec4 kAccent(0.42F, 0.78F, 0.94F, 1);

void heading(const char* text) {
    ImGui::Dummy(ImVec2(0, 0.6F * ImGui::GetFontSize()));
    ImGui::TextColored(kAccent, "%s", text);
    ImGui::Dummy(ImVec2(0, 0.1F * ImGui::GetFontSize()));
}

bool anyPressed(const InputEvents& input) {
    return !input.keysPressed.empty() || !input.text.empty() ||
           std::any_of(std::begin(input.buttonPressed), std::end(input.buttonPressed), [](bool b) { return b; });
}

}  // namespace

std::string seenFile() {
    for (const auto& [variable, below] : {std::pair("XDG_CONFIG_HOME", "rivulet/seen"), std::pair("HOME", ".config/rivulet/seen")}) {
        const char* root = std::getenv(variable);
        if (root != nullptr && root[0] == '/') return (fs::path(root) / below).string();
    }
    return {};
}

WelcomeScreen::WelcomeScreen(std::string seen) : seen_(std::move(seen)) {
    std::error_code error;
    shown_ = !seen_.empty() && !fs::exists(seen_, error);
}

void WelcomeScreen::draw(const InputEvents& input) {
    if (!shown_) return;
    if (anyPressed(input)) {
        shown_ = false;
        std::error_code error;
        fs::create_directories(fs::path(seen_).parent_path(), error);
        (void)writeFileAtomic(seen_, "rivulet's welcome screen was shown; delete this file to show it again\n");
        return;
    }
    // One window over all, so that no panel takes the click.
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos(ImVec2(0, 0));
    ImGui::SetNextWindowSize(display);
    ImGui::SetNextWindowFocus();
    ImGui::PushStyleColor(ImGuiCol_WindowBg, ImVec4(0.03F, 0.04F, 0.05F, 0.6F));
    ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 0);
    ImGui::Begin("first start", nullptr, ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings);
    const float em = ImGui::GetFontSize(), pad = 1.6F * em;
    const ImVec2 size(std::min(39 * em, display.x), std::min(tall_, display.y));
    ImGui::SetCursorPos(ImVec2(0.5F * (display.x - size.x), 0.5F * (display.y - size.y)));
    ImGui::PushStyleColor(ImGuiCol_ChildBg, ImVec4(0.07F, 0.09F, 0.11F, 0.97F));
    ImGui::PushStyleVar(ImGuiStyleVar_ChildRounding, 8);
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(pad, pad));
    ImGui::BeginChild("sheet", size, false, ImGuiWindowFlags_AlwaysUseWindowPadding);
    ImGui::PushTextWrapPos(0);
    ImGui::TextUnformatted("Rivulet simulates water in real time. Drag, pour and drop things into it while it runs.");
    heading("Controls");
    for (const auto& [key, does] : kGestures) {
        ImGui::TextUnformatted(key);
        ImGui::SameLine(pad + 6 * em);
        ImGui::TextDisabled("%s", does);
    }
    heading("Things to try");
    for (const char* each : kTries) {
        ImGui::Bullet();
        ImGui::TextUnformatted(each);
    }
    ImGui::Dummy(ImVec2(0, 0.8F * em));
    ImGui::TextDisabled("press any key or click to start");
    ImGui::PopTextWrapPos();
    tall_ = ImGui::GetCursorPosY() - ImGui::GetStyle().ItemSpacing.y + pad;
    ImGui::EndChild();
    ImGui::PopStyleVar(2);
    ImGui::PopStyleColor();
    ImGui::End();
    ImGui::PopStyleVar();
    ImGui::PopStyleColor();
}

}  // namespace rivulet
