#include "fluid/viewer/commands.h"

#include <imgui.h>

namespace rivulet {

Table<KeyRow> keys() {
    static constexpr KeyRow rows[] = {
        {"left drag", "turn the view"},
        {"right or middle drag", "move the view"},
        {"wheel", "nearer, farther"},
        {"click", "choose a mesh; a drop, on a skin"},
        {"drag a body", "lift it, throw it"},
        {"drag a handle", "move, turn what is chosen; control Z: back"},
        {"P", "pour with the left button, till P again", Command::pour, 'P'},
        {"space", "pause, go on", Command::pause, ' '},
        {"period", "one step", Command::step, '.'},
        {"R", "start again", Command::restart, 'R'},
        {"O", "open another scene", Command::scenes, 'O'},
        {"control S", "save the scene", Command::save, 'S', true, true},
        {"control F", "find a parameter", Command::find, 'F', true, true},
        {"drop a file", "a mesh, a scene, a sky"},
        {"F9", "a video, till F9 again", Command::video, key::kF1 + 8, false, true},
        {"F12", "a picture, without panels", Command::picture, key::kF1 + 11, false, true},
        {"Tab", "show, hide the panels", Command::panels, key::kTab},
        {"control plus, minus", "larger, smaller panels; 0: as before", Command::enlarge, '+', true},
        {"", "", Command::enlarge, '=', true},
        {"", "", Command::shrink, '-', true},
        {"", "", Command::usualSize, '0', true},
        {"", "", Command::undo, 'Z', true},
        {"", "", Command::release, key::kEscape},
        {"H", "show, hide this", Command::help, 'H'},
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
