// Textures painted from the surface itself: colour and relief come from noise in space at rest, so that the chart does not distort it.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "assets/make_head/eyes.h"

namespace rivulet::head {

inline constexpr int kTextureSize = 1024;
inline constexpr double kMillimetresPerStep = 0.004;  // of the relief's grey levels; 128 is the surface

struct Picture {
    int width = 0, height = 0, channels = 0;
    std::vector<uint8_t> bytes;  // first row on top
};

struct SkinPictures {
    Picture albedo, relief, regions, flush;  // flush: red, how much crying reddens; green, hollows
    size_t overlaps = 0;                     // texels that lie in two triangles
    double cheekMillimetres = 0;             // a texel's greater side on the cheeks, median
};

SkinPictures paintSkin(const Surface& head, const std::array<Eye, 2>& eyes);
Picture paintEye();
std::string asPng(const Picture& picture);
std::string asJpeg(const Picture& picture, int quality);

}  // namespace rivulet::head
