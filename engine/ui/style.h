// How the panels look: dark, quiet, one accent; a readable font where the system has one.
#pragma once

namespace rivulet {

// On the current ImGui context, before its first frame.
void applyUiStyle();

// Makes the font anew, for so many pixels a coordinate of ImGui's. Before ImGui::NewFrame.
void loadUiFont(float pixels);

}  // namespace rivulet
