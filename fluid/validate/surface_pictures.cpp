#include "fluid/validate/surface_pictures.h"

#include <algorithm>
#include <cmath>

#include "fluid/validate/image_flip.h"

namespace rivulet {

namespace {

void addGrey(std::vector<uint8_t>& to, double share) {
    const auto grey = static_cast<uint8_t>(std::lround(255 * std::clamp(share, 0.0, 1.0)));
    to.insert(to.end(), {grey, grey, grey, 255});
}

}  // namespace

std::vector<uint8_t> flipPicture(std::span<const uint8_t> reference, std::span<const uint8_t> test, int width, int height) {
    constexpr double kWhite = 0.5;
    std::vector<uint8_t> picture;
    for (const float f : flipMap(reference, test, width, height)) addGrey(picture, double{f} / kWhite);
    return picture;
}

std::vector<uint8_t> errorPicture(const SurfaceMap& measured, const SurfaceMap& reference) {
    constexpr double kWhite = 45;  // degrees
    std::vector<uint8_t> picture;
    for (int y = measured.height - 1; y >= 0; --y)
        for (int x = 0; x < measured.width; ++x) {
            const size_t i = static_cast<size_t>(y) * static_cast<size_t>(measured.width) + static_cast<size_t>(x);
            const bool a = measured.there(i), b = reference.there(i);
            if (a && b) {
                addGrey(picture, angleBetween(measured.normal[i], reference.normal[i]) / kWhite);
            } else {
                const uint8_t red = a ? 255 : 0, blue = b ? 255 : 0, none = a || b ? 0 : 40;
                picture.insert(picture.end(), {std::max(red, none), none, std::max(blue, none), 255});
            }
        }
    return picture;
}

}  // namespace rivulet
