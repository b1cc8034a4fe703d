// The files that a scene reads, so that no output is written over one of them.
#pragma once

#include <string>
#include <vector>

#include "fluid/scene/scene_file.h"

namespace rivulet {

struct SceneInput {
    std::string name;  // "the scene", or the parameter that names it: "colliders[0].mesh"
    std::string path;
};

// The scene file, and the files that its parameters name and that exist.
std::vector<SceneInput> inputsOf(SceneFile scene);

}  // namespace rivulet
