// SceneDraft: the scene as the panels edit it, and what of it was saved.
#pragma once

#include <string>

#include "engine/ui/param_panel.h"
#include "fluid/scene/scene_file.h"

namespace rivulet {

VisitFn visiting(SceneFile& scene);  // valid as long as the scene

struct SceneDraft {
    SceneFile scene;     // becomes the session's when it makes sense
    SceneFile settled;   // as it was before the edit under way
    ParamMemory params;  // of the parameter panel: what each value is reset to
    std::string saved;   // JSON of the scene as it was opened or saved last: textOf

    // The text of what an edit may change and a person may lose: not the camera, and with a budget, which picks them, not the fluid's
    // values.
    static std::string textOf(SceneFile scene, bool budget);
    bool edited(bool budget) const { return textOf(scene, budget) != saved; }
    // A reset of a value goes back to `opened` from now on.
    void remember(SceneFile opened, bool budget);
};

}  // namespace rivulet
