// Widgets for the parameters that a scene lists in `sliders`, shown above all other parameters.
#pragma once

#include "fluid/scene/scene_file.h"

namespace rivulet {

// Inside an ImGui window. Whether a value was changed. Values that need a new session are shown as text.
bool drawSceneSliders(SceneFile& scene);

}  // namespace rivulet
