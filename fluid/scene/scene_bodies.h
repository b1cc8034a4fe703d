// The bodies of a scene: shapes with their samples, forms for contact, and meshes to draw.
#pragma once

#include <vector>

#include "engine/scene/mesh.h"
#include "fluid/scene/scene_file.h"
#include "fluid/scene/solids_bullet.h"

namespace rivulet {

struct SceneBody {
    Body body;
    BodyForm form;
    Mesh mesh;                // in the body's own frame
    std::vector<Mesh> parts;  // of BodyParams::parts, in the same frame
};

// Error (badInput): a mesh that is missing, unreadable, open or inside out; the sentence names the body.
Result<std::vector<SceneBody>> sceneBodies(const SceneFile& scene);

}  // namespace rivulet
