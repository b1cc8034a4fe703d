// Buttons with an icon and a word. Icons are drawn as shapes, so that they need no font.
#pragma once

#include <imgui.h>

namespace rivulet {

enum class Icon { play, pause, step, reset, drop, scenes, save, picture, video, record, measure, keys, hide };

// As ImGui::Button. `on`: what it switches is on.
bool iconButton(Icon icon, const char* label, const ImVec2& size, bool on = false);
// The width that such a button needs, px.
float iconButtonWidth(const char* label);

}  // namespace rivulet
