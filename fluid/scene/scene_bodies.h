// The bodies of a scene: shapes with their samples, how they touch, and meshes to draw.
#pragma once

#include <vector>

#include "engine/scene/mesh.h"
#include "fluid/scene/scene_file.h"
#include "fluid/scene/solids_bullet.h"

namespace rivulet {

struct SceneBody {
    Body body;
    BodyForm form;
    Mesh mesh;                // in the body's own frame, as
    std::vector<Mesh> parts;  // of BodyParams::parts
};

// Error (badInput): a mesh that is missing, unreadable, open or inside out. Says which body.
Result<std::vector<SceneBody>> sceneBodies(const SceneFile& scene);

}  // namespace rivulet
