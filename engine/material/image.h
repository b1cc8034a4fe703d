// Image: decoded texels in memory, the bottom row first, as uvs with v up count them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace rivulet {

struct Image {
    std::string name;
    int width = 0, height = 0;
    std::vector<uint8_t> rgba;  // 4 a texel, as stored in the file
};

}  // namespace rivulet
