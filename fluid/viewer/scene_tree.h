// The objects of a scene as a tree: meshes with the nodes of their files, bodies, skins, emitters, sinks, blocks.
#pragma once

#include <string>

#include "fluid/viewer/manipulator.h"

namespace rivulet {

struct TreeAsks {
    bool edited = false;  // the draft: an object was shown or hidden
    std::string find;     // the path of the clicked object's params: "colliders[2]"; "": no click
};

// Inside an ImGui window. A click selects an object; its check box shows or hides it.
TreeAsks drawSceneTree(const Session& session, SceneFile& draft, Manipulator& hand);

}  // namespace rivulet
