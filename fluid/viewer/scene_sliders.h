// The parameters that a scene names in `sliders`, above all others: what a person who sees it for the first time plays with.
#pragma once

#include "fluid/scene/scene_file.h"

namespace rivulet {

// Inside an ImGui window. Whether a value was changed. Values that need a new session are shown as text.
bool drawSceneSliders(SceneFile& scene);

}  // namespace rivulet
