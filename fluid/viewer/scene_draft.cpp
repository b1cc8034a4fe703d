#include "fluid/viewer/scene_draft.h"

#include "engine/core/json.h"

namespace rivulet {

VisitFn visiting(SceneFile& scene) {
    return [&scene](ParamVisitor& v) { scene.visit(v); };
}

std::string SceneDraft::textOf(SceneFile scene, bool budget) {
    scene.camera = {};
    if (budget) scene.fluid = {};
    return writeJson(visiting(scene));
}

void SceneDraft::remember(SceneFile opened, bool budget) {
    SceneFile none;
    if (budget) opened.fluid = scene.fluid;
    params.open(visiting(opened), visiting(none));
    params.compare(visiting(scene));
    saved = textOf(opened, budget);
}

}  // namespace rivulet
