#include "fluid/scene/move_pictures.h"

#include <algorithm>
#include <cmath>

#include "fluid/flow/uv_triangle.h"

namespace rivulet {

namespace {

constexpr double kGutter = 4;  // texels beyond a chart's edge that are coloured too

// Bilinear, and round again beyond 0 to 1.
std::array<double, 4> sampled(const Image& image, const dvec2& uv) {
    const dvec2 at = (uv - glm::floor(uv)) * dvec2(image.width, image.height) - 0.5, low = glm::floor(at), share = at - low;
    std::array<double, 4> sum{};
    for (int k = 0; k < 4; ++k) {
        const int x = (static_cast<int>(low.x) + k % 2 + image.width) % image.width,
                  y = (static_cast<int>(low.y) + k / 2 + image.height) % image.height;
        const double weight = (k % 2 != 0 ? share.x : 1 - share.x) * (k / 2 != 0 ? share.y : 1 - share.y);
        const uint8_t* texel = &image.rgba[4 * (static_cast<size_t>(y) * static_cast<size_t>(image.width) + static_cast<size_t>(x))];
        for (size_t c = 0; c < 4; ++c) sum[c] += weight * texel[c];
    }
    return sum;
}

// Of each texel of the new picture the place in the old ones; not a number where no chart is near.
std::vector<dvec2> placesOf(std::span<const vec2> from, std::span<const vec2> to, int size) {
    const double none = std::nan("");
    std::vector<dvec2> places(static_cast<size_t>(size) * static_cast<size_t>(size), dvec2(none));
    std::vector<double> off(places.size(), 1.0e300);  // beyond the nearest triangle's edge
    for (size_t t = 0; t + 2 < to.size(); t += 3) {
        const UvTriangle f = uvTriangle(to.subspan(t, 3), size);
        if (!f.good()) continue;
        const dvec2 low = glm::max(glm::ceil(f.low() - kGutter), dvec2(0.0)),
                    high = glm::min(glm::floor(f.high() + kGutter), dvec2(size - 1));
        for (int y = static_cast<int>(low.y); y <= static_cast<int>(high.y); ++y)
            for (int x = static_cast<int>(low.x); x <= static_cast<int>(high.x); ++x) {
                dvec2 uv(0.0);
                double beyond = 0;  // texels
                for (size_t k = 0; k < 3; ++k) {
                    const dvec2 &a = f.p[(k + 1) % 3], &b = f.p[(k + 2) % 3];
                    const double share = cross2(b - a, dvec2(x, y) - a) / f.area;
                    beyond = std::max(beyond, -share * std::abs(f.area) / std::max(glm::distance(a, b), 1.0e-9));
                    uv += share * dvec2(from[t + k]);
                }
                const size_t at = static_cast<size_t>(y) * static_cast<size_t>(size) + static_cast<size_t>(x);
                if (beyond > kGutter || beyond >= off[at] || !std::isfinite(uv.x + uv.y)) continue;
                off[at] = beyond;
                places[at] = uv;
            }
    }
    return places;
}

std::shared_ptr<const Image> moved(const std::shared_ptr<const Image>& image, const std::vector<dvec2>& places, int size) {
    if (image == nullptr || image->width < 1 || image->height < 1) return image;
    auto made = std::make_shared<Image>();
    made->name = image->name;
    made->width = made->height = size;
    made->rgba.assign(4 * places.size(), 0);
    std::array<double, 4> mean{};
    for (size_t k = 0; k < image->rgba.size(); ++k) mean[k % 4] += 4.0 * image->rgba[k] / static_cast<double>(image->rgba.size());
    for (size_t k = 0; k < places.size(); ++k) {
        const std::array<double, 4> texel = std::isfinite(places[k].x) ? sampled(*image, places[k]) : mean;
        for (size_t c = 0; c < 4; ++c) made->rgba[4 * k + c] = static_cast<uint8_t>(std::clamp(std::lround(texel[c]), 0L, 255L));
    }
    return made;
}

}  // namespace

bool movePictures(Material& m, std::span<const vec2> from, std::span<const vec2> to, int size) {
    const bool any = m.colour || m.metallicRoughness || m.occlusion || m.glow || m.normals ||
                     (m.skin && (m.skin->relief || m.skin->regions || m.skin->flushes));
    if (!any) return false;
    const std::vector<dvec2> places = placesOf(from, to, size);
    for (std::shared_ptr<const Image>* image : {&m.colour, &m.metallicRoughness, &m.occlusion, &m.glow})
        *image = moved(*image, places, size);
    m.normals = nullptr;
    if (m.skin) {
        auto skin = std::make_shared<SkinLook>(*m.skin);
        skin->relief = moved(skin->relief, places, size);
        skin->regions = moved(skin->regions, places, size);
        skin->flushes = moved(skin->flushes, places, size);
        m.skin = std::move(skin);
    }
    return true;
}

}  // namespace rivulet
