// Image: decoded texels in memory, the bottom row first, as uvs with v up count them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/core/math.h"

namespace rivulet {

struct Image {
    std::string name;
    int width = 0, height = 0;
    std::vector<uint8_t> rgba;  // 4 a texel, as stored in the file
};

// What surrounds a scene: linear radiance in every direction, as an equirectangular map. Its middle is -z, its top row +y; rows as above.
struct HdrImage {
    std::string name;
    int width = 0, height = 0;
    std::vector<vec3> texels;
};

}  // namespace rivulet
