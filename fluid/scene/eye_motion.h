// How eyes move with an expression: eyeballs turn as rigid bodies, and a blink ends where the lids meet, whatever else has moved them.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/scene/model.h"

namespace rivulet {

// A morph target moves points along straight lines, so a ball shrinks between rest and a look, and its frame stays behind. Where the
// targets of an eyeball are rotations, it is turned instead.
struct EyeTurns {
    vec3 centre{0.0F};                  // m
    std::map<std::string, vec3> turns;  // of each target: axis, as long as the angle at weight 1, rad
    mat4 at(const vec3& turn) const;
};

// If all morph targets of the part are rotations about one of `centres`, they are removed from it and returned. Else, or if it has none,
// nothing is returned and the part stays as it is.
std::optional<EyeTurns> takeEyeTurns(ModelPart& part, std::span<const vec3> centres);

// The share of a blink's way that each of `morphs` moves the lid, where the blink moves it furthest; the blink's own is 1.
std::vector<float> sharesOfBlink(const std::vector<MorphTarget>& morphs, size_t blink);

}  // namespace rivulet
