// The head's expressions, each as a displacement of every vertex at weight 1.
#pragma once

#include <string>
#include <vector>

#include "assets/make_head/eyes.h"

namespace rivulet::head {

inline const std::vector<std::string> kMorphNames = {"blinkLeft", "blinkRight", "browInnerUp", "browDown", "squintLeft", "squintRight",
                                                     "frown",     "mouthOpen",  "mouthPucker", "smile",    "cheekRaise"};

std::vector<std::vector<dvec3>> makeMorphs(const Surface& head, const std::array<Eye, 2>& eyes);
// The same for lashes, which go with the lid they grow from.
std::vector<std::vector<dvec3>> lashMorphs(const Part& lashes, const std::vector<Lash>& ofVertex, const Surface& head, const Eye& eye,
                                           const std::vector<std::vector<dvec3>>& skin);

}  // namespace rivulet::head
