// Gives a head's parts the looks that glTF has no words for: skin, eyes.
#pragma once

#include <string>

#include "engine/core/result.h"
#include "engine/scene/model.h"

namespace rivulet {

// The eyeball in a mesh: the sphere that fits its vertices best, looking where the uvs' middle is.
EyeLook eyeLookOf(const Mesh& mesh);

// The part `skin` becomes skin, with head_relief.png and skin_regions.png of `folder` where they are there; parts whose names begin with
// `eye` and that are not blended become eyes, `caruncle` flesh, `lashes` soft-edged hairs if they are ribbons whose u runs across. Parts
// that are not there are no error; a picture that is damaged is.
Status dressHead(Model& head, const std::string& folder);

}  // namespace rivulet
