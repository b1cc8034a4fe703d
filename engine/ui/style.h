// How the panels look: dark, quiet, one accent; a readable font where the system has one.
#pragma once

#include <imgui.h>

namespace rivulet {

// On the current ImGui context, before its first frame.
void applyUiStyle();

inline ImVec4 refusedColour() { return {0.98F, 0.55F, 0.45F, 1}; }  // of the sentence that says why

// Makes the font anew, for so many pixels a coordinate of ImGui's. Before ImGui::NewFrame.
void loadUiFont(float pixels);

}  // namespace rivulet
