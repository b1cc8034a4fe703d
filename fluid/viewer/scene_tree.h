// What there is in a scene, as a tree: meshes with the nodes of their files, bodies, skins, emitters, sinks, blocks.
#pragma once

#include <string>

#include "fluid/viewer/manipulator.h"

namespace rivulet {

struct TreeAsks {
    bool edited = false;  // whether something is drawn was changed in the draft
    std::string find;     // the path of what was clicked, to look its Params up: "colliders[2]"; "": nothing was
};

// Inside an ImGui window. A click chooses; a box says whether a thing is drawn.
TreeAsks drawSceneTree(const Session& session, SceneFile& draft, Manipulator& hand);

}  // namespace rivulet
