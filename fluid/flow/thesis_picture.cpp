#include "fluid/flow/thesis_picture.h"

#include <algorithm>
#include <cmath>

#include "engine/core/assert.h"

namespace rivulet {

ThesisPicture thesisPicture(std::span<const ThesisParticle> particles, int size, float radius, float largest, float relief) {
    ASSERT(size > 0 && largest > 0, "give the picture a size, and the largest mass");
    ThesisPicture p;
    p.size = size;
    const auto edge = static_cast<size_t>(size);
    p.height.assign(edge * edge, 0.0F);
    const auto texels = static_cast<float>(size);
    for (const ThesisParticle& particle : particles) {
        const float share = std::clamp(particle.mass / largest, 0.0F, 1.0F), r = radius * share * texels;
        const vec2 at = particle.uv * texels - 0.5F;
        if (!(r > 0) || !isFinite(vec3(at, 0.0F))) continue;
        const vec2 low = glm::max(glm::ceil(at - r), vec2(0.0F)), high = glm::min(glm::floor(at + r), vec2(texels - 1));
        for (float y = low.y; y <= high.y; ++y)
            for (float x = low.x; x <= high.x; ++x) {
                // W: the poly6 kernel of the thesis, 1 in its middle.
                const float q = glm::dot(vec2(x, y) - at, vec2(x, y) - at) / (r * r), left = std::max(1 - q, 0.0F);
                p.height[static_cast<size_t>(y) * edge + static_cast<size_t>(x)] += share * left * left * left;
            }
    }
    p.normal.reserve(edge * edge);
    for (size_t y = 0; y < edge; ++y)
        for (size_t x = 0; x < edge; ++x) {
            const float here = p.height[y * edge + x];
            const float du = here - p.height[y * edge + std::min(x + 1, edge - 1)];
            const float dv = here - p.height[std::min(y + 1, edge - 1) * edge + x];
            p.normal.push_back(glm::normalize(vec3(relief * du, relief * dv, 1.0F)));
        }
    return p;
}

std::vector<uint8_t> greyOf(const ThesisPicture& picture) {
    const auto edge = static_cast<size_t>(picture.size);
    std::vector<uint8_t> rgba;
    rgba.reserve(4 * edge * edge);
    for (size_t y = edge; y-- > 0;)
        for (size_t x = 0; x < edge; ++x) {
            const auto grey = static_cast<uint8_t>(std::lround(255 * std::min(picture.height[y * edge + x], 1.0F)));
            rgba.insert(rgba.end(), {grey, grey, grey, 255});
        }
    return rgba;
}

}  // namespace rivulet
