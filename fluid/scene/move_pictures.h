// The pictures of a material on other UVs: for a skin whose own UVs cannot be used.
#pragma once

#include <span>

#include "engine/material/material.h"

namespace rivulet {

// Draws colour, metallicRoughness, occlusion and glow, and the pictures of a skin, anew: `to` shows what `from` showed. `from`, `to`: UVs
// of the same corners, 3 a triangle; `to` within 0 to 1 and without overlap. `size`: texels of the new pictures' edge. Normals are left
// out, because their directions are those of the old UVs. True if there was a
// picture.
bool movePictures(Material& material, std::span<const vec2> from, std::span<const vec2> to, int size);

}  // namespace rivulet
