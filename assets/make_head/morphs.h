// The head's expressions, each as a displacement of every vertex at weight 1.
#pragma once

#include <string>
#include <vector>

#include "assets/make_head/eyes.h"

namespace rivulet::head {

inline const std::vector<std::string> kMorphNames = {
    "blinkLeft", "blinkRight",  "browInnerUp", "browDown",     "browKnit",   "squintLeft", "squintRight",   "frown",
    "mouthOpen", "mouthPucker", "smile",       "mouthStretch", "mouthPress", "chinRaise",  "upperLipRaise", "cheekRaise",
    "swallow",   "lookLeft",    "lookRight",   "lookUp",       "lookDown",   "brimLeft",   "brimRight"};
inline constexpr double kGazeTurns = 25 * kPi / 180;  // of the morphs look..., which turn both eyes

std::vector<std::vector<dvec3>> makeMorphs(const Surface& head, const std::array<Eye, 2>& eyes);
// The same for lashes, which go with the lid they grow from.
// `wet`: where the vertices are when the lid is full, see clumped().
std::vector<std::vector<dvec3>> lashMorphs(const Part& lashes, const std::vector<Lash>& ofVertex, const Surface& head, const Eye& eye,
                                           const std::vector<std::vector<dvec3>>& skin, const std::vector<dvec3>& wet);
// The morphs of a part that follows the skin: each of its vertices moves as the vertex of the skin that is given for it.
std::vector<std::vector<dvec3>> carriedMorphs(const std::vector<uint32_t>& roots, const std::vector<std::vector<dvec3>>& skin);
// Of an eyeball or its cornea, which turns about the eye's centre.
std::vector<std::vector<dvec3>> eyeMorphs(const Part& part, const Eye& eye);
// Of a part that goes with the jaw, each vertex by its share.
std::vector<std::vector<dvec3>> jawMorphs(const Part& part, const std::vector<double>& jaw);

}  // namespace rivulet::head
