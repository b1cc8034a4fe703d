// Clouds are value noise in octaves (Perlin 1985) on a plane overhead, lit by how much thinner they are towards the sun.
#include "engine/render/made_sky.h"

#include <algorithm>
#include <cmath>

namespace rivulet {
namespace {

constexpr int kWidth = 1024, kHeight = 512;

float hashed(int x, int y) {
    uint32_t k = static_cast<uint32_t>(x) * 374761393U + static_cast<uint32_t>(y) * 668265263U;
    k = (k ^ (k >> 13U)) * 1274126177U;
    return static_cast<float>((k ^ (k >> 16U)) & 0xFFFFU) / 65535.0F;
}

// 0..1
float noise(const vec2& p) {
    const vec2 cell = glm::floor(p), f = p - cell, w = f * f * (3.0F - 2.0F * f);
    const int x = static_cast<int>(cell.x), y = static_cast<int>(cell.y);
    return glm::mix(glm::mix(hashed(x, y), hashed(x + 1, y), w.x), glm::mix(hashed(x, y + 1), hashed(x + 1, y + 1), w.x), w.y);
}

float octaves(vec2 p) {
    float sum = 0, share = 0.5F;
    for (int k = 0; k < 6; ++k, share *= 0.5F) {
        sum += share * noise(p);
        p = 2.03F * vec2(0.8F * p.x - 0.6F * p.y, 0.6F * p.x + 0.8F * p.y) +
            vec2(17.0F, 5.0F);  // rotated, so that the noise lattice is not visible
    }
    return sum;
}

float cover(const vec2& p, float clouds) {
    const float from = 0.70F - 0.54F * clouds;
    return glm::smoothstep(from, from + 0.30F, octaves(p));
}

vec3 radiance(const vec3& d, const SkyLook& look) {
    const float up = std::max(d.y, 0.0F), facing = std::max(glm::dot(d, look.sun), 0.0F);
    const float glow = 0.05F * std::pow(facing, 6.0F) + 0.25F * std::pow(facing, 60.0F) + 1.5F * std::pow(facing, 900.0F);
    vec3 sky = glm::mix(look.horizon, look.zenith, 1.0F - std::exp(-3.2F * up)) + look.sunlight * glow;
    if (d.y > 0) {
        const vec2 at = 1.6F * vec2(d.x, d.z) / (d.y + 0.16F), sunwards = 0.22F * vec2(look.sun.x, look.sun.z);
        const float here = cover(at, look.clouds), lit = glm::clamp(0.55F + 0.9F * (here - cover(at + sunwards, look.clouds)), 0.0F, 1.0F);
        const vec3 shade = 0.75F * look.horizon + 0.25F * look.zenith,
                   bright = 1.25F * look.horizon + look.sunlight * (0.10F + 1.2F * glow);
        sky = glm::mix(sky, glm::mix(shade, bright, lit), 0.9F * here * glm::smoothstep(0.02F, 0.22F, d.y));
    }
    const vec3 ground =
        look.ground * (look.sunlight * (std::max(look.sun.y, 0.0F) / kPi) + 0.55F * glm::mix(look.horizon, look.zenith, 0.6F));
    return glm::mix(sky, glm::mix(look.horizon, ground, 1.0F - std::exp(-6.0F * std::max(-d.y, 0.0F))),
                    glm::smoothstep(0.004F, -0.004F, d.y));
}

}  // namespace

HdrImage makeSky(const SkyLook& look) {
    HdrImage sky{.name = "sky", .width = kWidth, .height = kHeight, .texels = {}};
    sky.texels.reserve(size_t{kWidth} * kHeight);
    for (int y = 0; y < kHeight; ++y) {
        const float up = ((static_cast<float>(y) + 0.5F) / kHeight - 0.5F) * kPi;
        for (int x = 0; x < kWidth; ++x) {
            const float turn = ((static_cast<float>(x) + 0.5F) / kWidth - 0.5F) * 2 * kPi;
            sky.texels.push_back(radiance({std::cos(up) * std::sin(turn), std::sin(up), -std::cos(up) * std::cos(turn)}, look));
        }
    }
    return sky;
}

}  // namespace rivulet
