// How the panels look: dark, quiet, one accent; a readable font where the system has one.
#pragma once

#include <imgui.h>

namespace rivulet {

// On the current ImGui context, before its first frame.
void applyUiStyle();

inline ImVec4 refusedColour() { return {0.98F, 0.55F, 0.45F, 1}; }  // of the sentence that says why

// Creates the font again for a number of pixels per coordinate of ImGui. Call it before ImGui::NewFrame.
void loadUiFont(float pixels);

}  // namespace rivulet
