// EnvironmentMap: the surroundings of a scene from an image, prefiltered on load: a chain of blurred levels, and the diffuse irradiance.
#pragma once

#include <array>
#include <vector>

#include "engine/compute/disk_cache.h"
#include "engine/gpu/texture.h"
#include "engine/material/image.h"
#include "engine/render/made_sky.h"

namespace rivulet {

// The radiance of a white diffuse surface by its normal: nine spherical harmonics per colour, convolved with the cosine lobe (Ramamoorthi
// and Hanrahan 2001). Basis by normal n: 1, y, z, x, xy, yz, 3z^2 - 1, xz, x^2 - y^2.
std::array<vec4, 9> matteLight(const HdrImage& surroundings);

// The prefiltered surroundings.
struct Environment {
    int width = 0;                        // texels of the first mip: the width of the image, but 256 to 1024; the height is half of it
    std::vector<std::vector<vec3>> mips;  // each is blurred by about one texel, so that roughness selects a level; the last is one texel
    std::array<vec4, 9> matte{};          // matteLight()
};
Environment prefiltered(const HdrImage& surroundings);
// The same result from the cache; if it is not there, it is computed and stored.
Environment cachedEnvironment(const HdrImage& surroundings, const DiskCache& cache);
// The same of makeSky(sky), which is made only if the result is not in the cache.
Environment cachedEnvironment(const SkyLook& sky, const DiskCache& cache);

// The mips as an rgba16f texture. Error (failed): out of GPU memory.
Result<gpu::Texture> makeEnvironmentMap(const Environment& from);

}  // namespace rivulet
