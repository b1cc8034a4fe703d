#include "fluid/scene/scene_inputs.h"

#include <filesystem>

#include "engine/core/param_list.h"

namespace rivulet {

std::vector<SceneInput> inputsOf(SceneFile scene) {
    std::vector<SceneInput> inputs = {{"the scene", scene.source.path}};
    for (const ParamEntry& entry : listParams([&scene](ParamVisitor& v) { scene.visit(v); })) {
        if (entry.kind != ParamEntry::Kind::value || !entry.text.starts_with('"')) continue;
        const std::string text = plainText(entry.text);
        if (std::filesystem::path(text).extension().empty()) continue;
        if (Result<std::string> file = findAsset(text, scene.folder)) inputs.push_back({entry.path, *file});
    }
    return inputs;
}

}  // namespace rivulet
