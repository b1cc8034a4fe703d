// Image: decoded texels in memory, the bottom row first, so that v points up.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/core/math.h"

namespace rivulet {

struct Image {
    std::string name;
    int width = 0, height = 0;
    std::vector<uint8_t> rgba;  // 4 bytes per texel, as stored in the file
};

// The surroundings of a scene: linear radiance in all directions, as an equirectangular map. The centre of the map is -z, the top row is
// +y. The bottom row is stored first.
struct HdrImage {
    std::string name;
    int width = 0, height = 0;
    std::vector<vec3> texels;
};

}  // namespace rivulet
