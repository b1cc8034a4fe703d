// Materials of a head's parts that glTF cannot describe: skin, eyes.
#pragma once

#include <string>

#include "engine/core/result.h"
#include "engine/scene/model.h"
#include "fluid/scene/find_face.h"

namespace rivulet {

// The eyeball in a mesh: the sphere that fits its vertices best, looking towards the centre of its uvs.
EyeLook eyeLookOf(const Mesh& mesh);

// The tear film along a lower lid: a blended, mirror-like strip that curves from the lid's edge to the eyeball. It follows the skin's
// morph targets; one named tearLineLeft gets a target brimLeft, the film as full as a lid holds. `width`: m, from the lid to where it ends
// on the eye. Nothing where no lid is near the eye.
ModelPart makeTearLine(const ModelPart& skin, const EyeLook& eye, const std::string& name, float width = 0.8e-3F);

// The part `skin` becomes skin, with head_relief.png, skin_regions.png and head_flush.jpg of `folder` where they are there; parts whose
// names begin with `eye` and that are not blended become eyes, `caruncle` flesh, `lashes` soft-edged hairs if they are ribbons whose u runs
// across. Parts that are not there are no error; a picture that is damaged is. Each eye gets a tear line, as parts `tearLine` + what
// follows `eye` in its name.
// Parts `hair` and `brows` on ribbons (a pair of vertices across each, see Material::strand) become hairs; `teeth` and `tongue` without a
// picture of occlusion stand in the shade of a mouth.
Status dressHead(Model& head, const std::string& folder);
// For a head without such names, if its face was found by its eyeballs: makes them shine, and adds a tear line along each lower lid. Their
// pictures stay as the file lays them. Nothing where the head does not stand upright.
void wetFoundEyes(Model& head, size_t skin, const FoundFace& face);

}  // namespace rivulet
