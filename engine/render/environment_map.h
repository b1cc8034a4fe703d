// EnvironmentMap: a scene's surroundings from a picture, made ready on load: blurred more and more, and what a matte surface gets of them.
#pragma once

#include <array>
#include <vector>

#include "engine/compute/disk_cache.h"
#include "engine/gpu/texture.h"
#include "engine/material/image.h"

namespace rivulet {

// Radiance over the sphere as nine numbers a colour, already spread over a cosine: what a white matte surface returns (Ramamoorthi and
// Hanrahan 2001). By normal n: 1, y, z, x, xy, yz, 3z^2 - 1, xz, x^2 - y^2.
std::array<vec4, 9> matteLight(const HdrImage& surroundings);

// What a picture comes to as surroundings.
struct Environment {
    int width = 0;                        // texels of the first mip: 256, or as wide as the picture up to 1024; half as high
    std::vector<std::vector<vec3>> mips;  // each blurred by about its own texel, so that roughness picks one; the last is one texel
    std::array<vec4, 9> matte{};          // matteLight()
};
Environment prefiltered(const HdrImage& surroundings);
// The same, bit for bit, from a cache where it is there; else kept in it.
Environment cachedEnvironment(const HdrImage& surroundings, const DiskCache& cache);

// As rgba16f. Error (failed): out of GPU memory.
Result<gpu::Texture> makeEnvironmentMap(const Environment& from);

}  // namespace rivulet
