#include "fluid/viewer/commands.h"

#include <imgui.h>

namespace rivulet {

Table<KeyRow> keys() {
    static constexpr KeyRow rows[] = {
        {"left drag", "rotate the view"},
        {"right or middle drag", "pan the view"},
        {"wheel", "zoom"},
        {"click", "select a mesh; on a skin, add a drop"},
        {"drag a body", "lift and throw it"},
        {"drag a handle", "move or rotate the selection"},
        {"P", "pour with the left button; P again stops", Command::pour, 'P'},
        {"space", "pause or resume", Command::pause, ' '},
        {"period", "advance one step", Command::step, '.'},
        {"R", "restart the simulation", Command::restart, 'R'},
        {"O", "open another scene", Command::scenes, 'O'},
        {"Ctrl+S", "save the scene", Command::save, 'S', true, true},
        {"Ctrl+F", "find a parameter", Command::find, 'F', true, true},
        {"drop a file", "add a mesh, open a scene, set a sky (.hdr)"},
        {"F8", "record the run to scrub through it; F8 again stops", Command::record, key::kF1 + 7, false, true},
        {"F9", "record a video; F9 again stops", Command::video, key::kF1 + 8, false, true},
        {"F12", "save a picture without panels", Command::picture, key::kF1 + 11, false, true},
        {"M", "show or hide the measurements", Command::measure, 'M'},
        {"Tab", "show or hide the panels", Command::panels, key::kTab},
        {"Ctrl+plus, minus, 0", "enlarge, shrink, reset the panels' text", Command::enlarge, '+', true},
        {"", "", Command::enlarge, '=', true},
        {"", "", Command::shrink, '-', true},
        {"", "", Command::usualSize, '0', true},
        {"Ctrl+Z", "undo a move; return to an unsaved scene", Command::undo, 'Z', true},
        {"", "", Command::release, key::kEscape},
        {"H", "show or hide this list", Command::help, 'H'},
    };
    return {rows};
}

std::vector<Command> commandsOf(const InputEvents& input, bool typing) {
    const bool control = input.down(key::kLeftControl) || input.down(key::kRightControl);
    std::vector<Command> commands;
    for (const KeyRow& row : keys().rows)
        if (row.command != Command::none && (!typing || row.whileTyping) && (!row.control || control) && input.pressed(row.key))
            commands.push_back(row.command);
    return commands;
}

void drawKeyHelp() {
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos(ImVec2(display.x / 2, display.y / 2), ImGuiCond_Always, ImVec2(0.5F, 0.5F));
    ImGui::Begin("keys", nullptr,
                 ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_AlwaysAutoResize);
    for (const KeyRow& row : keys().rows) {
        if (row.name[0] == '\0') continue;
        ImGui::TextUnformatted(row.name);
        ImGui::SameLine(ImGui::GetFontSize() * 12);
        ImGui::TextDisabled("%s", row.doc);
    }
    ImGui::Dummy(ImVec2(ImGui::GetFontSize() * 24, 1));
    ImGui::End();
}

}  // namespace rivulet
