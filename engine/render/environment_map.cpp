#include "engine/render/environment_map.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace rivulet {
namespace {

constexpr int kNarrowest = 256, kWidest = 1024;

struct Picture {
    int width = 0, height = 0;
    std::vector<vec3> texels;
    // Across the seam it goes on; at the poles it ends.
    const vec3& at(int x, int y) const {
        const int u = ((x % width) + width) % width, v = std::clamp(y, 0, height - 1);
        return texels[static_cast<size_t>(v) * static_cast<size_t>(width) + static_cast<size_t>(u)];
    }
};

Picture shrunk(const Picture& from, int width, int height) {
    Picture to{width, height, {}};
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const int x0 = x * from.width / width, x1 = std::max((x + 1) * from.width / width, x0 + 1);
            const int y0 = y * from.height / height, y1 = std::max((y + 1) * from.height / height, y0 + 1);
            vec3 sum(0.0F);
            for (int v = y0; v < y1; ++v)
                for (int u = x0; u < x1; ++u) sum += from.at(u, v);
            to.texels.push_back(sum / static_cast<float>((x1 - x0) * (y1 - y0)));
        }
    return to;
}

// By one texel of the equator; nearer the poles that is more texels of a row.
Picture blurred(const Picture& from) {
    Picture across = from, to = from;
    for (int y = 0; y < from.height; ++y) {
        const float latitude = (static_cast<float>(y) + 0.5F) / static_cast<float>(from.height) * kPi;
        const int reach = std::clamp(static_cast<int>(std::lround(1.0F / std::max(std::sin(latitude), 0.02F))), 1, from.width / 4 + 1);
        for (int x = 0; x < from.width; ++x) {
            vec3 sum(0.0F);
            float weights = 0;
            for (int k = -2 * reach; k <= 2 * reach; ++k) {
                const float w = std::exp(-0.5F * static_cast<float>(k * k) / static_cast<float>(reach * reach));
                sum += w * from.at(x + k, y);
                weights += w;
            }
            across.texels[static_cast<size_t>(y * from.width + x)] = sum / weights;
        }
    }
    for (int y = 0; y < from.height; ++y)
        for (int x = 0; x < from.width; ++x)
            to.texels[static_cast<size_t>(y * from.width + x)] =
                (across.at(x, y - 2) + 4.0F * across.at(x, y - 1) + 6.0F * across.at(x, y) + 4.0F * across.at(x, y + 1) +
                 across.at(x, y + 2)) /
                16.0F;
    return to;
}

}  // namespace

std::array<vec4, 9> matteLight(const HdrImage& from) {
    std::array<glm::dvec3, 9> sum{};
    for (int y = 0; y < from.height; ++y) {
        const double up = (y + 0.5) / from.height * double{kPi} - 0.5 * double{kPi};
        const double area = 2 * double{kPi} / from.width * (double{kPi} / from.height) * std::cos(up);
        for (int x = 0; x < from.width; ++x) {
            const double turn = ((x + 0.5) / from.width - 0.5) * 2 * double{kPi};
            const glm::dvec3 d(std::cos(up) * std::sin(turn), std::sin(up), -std::cos(up) * std::cos(turn));
            const glm::dvec3 light =
                glm::dvec3(from.texels[static_cast<size_t>(y) * static_cast<size_t>(from.width) + static_cast<size_t>(x)]) * area;
            const double basis[9] = {1, d.y, d.z, d.x, d.x * d.y, d.y * d.z, 3 * d.z * d.z - 1, d.x * d.z, d.x * d.x - d.y * d.y};
            for (size_t k = 0; k < 9; ++k) sum[k] += light * basis[k];
        }
    }
    // Each basis function's square over the sphere, and what a cosine leaves of its order: 1, 2/3, 1/4.
    constexpr double kPi4 = 4 * double{kPi};
    const double share[9] = {1 / kPi4,      2 / kPi4,      2 / kPi4,      2 / kPi4,      15 / kPi4 / 4,
                             15 / kPi4 / 4, 5 / kPi4 / 16, 15 / kPi4 / 4, 15 / kPi4 / 16};
    std::array<vec4, 9> out;
    for (size_t k = 0; k < 9; ++k) out[k] = vec4(vec3(sum[k] * share[k]), 0.0F);
    return out;
}

Result<gpu::Texture> makeEnvironmentMap(const HdrImage& from) {
    int width = kNarrowest;
    while (2 * width <= std::min(from.width, kWidest)) width *= 2;
    Result<gpu::Texture> map = gpu::Texture::create({.width = width, .height = width / 2, .format = gpu::Format::rgba16f, .mips = 0});
    if (!map) return map;
    map->setSampling({.wrap = gpu::Wrap::repeat});
    Picture level = shrunk({from.width, from.height, from.texels}, width, width / 2);
    for (int mip = 0; mip < map->desc().mips; ++mip) {
        if (mip > 0) level = shrunk(blurred(level), map->width(mip), map->height(mip));
        std::vector<vec4> texels;
        for (const vec3& t : level.texels) texels.emplace_back(t, 1.0F);
        map->upload(std::as_bytes(std::span(texels)), mip);
    }
    return map;
}

}  // namespace rivulet
