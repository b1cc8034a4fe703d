// EnvironmentMap: a scene's surroundings from a picture, made ready on load: blurred more and more, and what a matte surface gets of them.
#pragma once

#include <array>

#include "engine/gpu/texture.h"
#include "engine/material/image.h"

namespace rivulet {

// Radiance over the sphere as nine numbers a colour, already spread over a cosine: what a white matte surface returns (Ramamoorthi and
// Hanrahan 2001). By normal n: 1, y, z, x, xy, yz, 3z^2 - 1, xz, x^2 - y^2.
std::array<vec4, 9> matteLight(const HdrImage& surroundings);

// 256 x 128, or as wide as the picture up to 1024, rgba16f: each mip is blurred by about its own texel, so that roughness picks one. Error
// (failed): out of GPU memory.
Result<gpu::Texture> makeEnvironmentMap(const HdrImage& surroundings);

}  // namespace rivulet
