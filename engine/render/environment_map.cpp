#include "engine/render/environment_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace rivulet {
namespace {

constexpr int kNarrowest = 256, kWidest = 1024;

struct Picture {
    int width = 0, height = 0;
    std::vector<vec3> texels;
    // u wraps around; v is clamped at the poles.
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

// Blurs by one texel at the equator, which is more texels of a row near the poles.
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
    std::array<dvec3, 9> sum{};
    for (int y = 0; y < from.height; ++y) {
        const double up = (y + 0.5) / from.height * double{kPi} - 0.5 * double{kPi};
        const double area = 2 * double{kPi} / from.width * (double{kPi} / from.height) * std::cos(up);
        for (int x = 0; x < from.width; ++x) {
            const double turn = ((x + 0.5) / from.width - 0.5) * 2 * double{kPi};
            const dvec3 d(std::cos(up) * std::sin(turn), std::sin(up), -std::cos(up) * std::cos(turn));
            const dvec3 light =
                dvec3(from.texels[static_cast<size_t>(y) * static_cast<size_t>(from.width) + static_cast<size_t>(x)]) * area;
            const double basis[9] = {1, d.y, d.z, d.x, d.x * d.y, d.y * d.z, 3 * d.z * d.z - 1, d.x * d.z, d.x * d.x - d.y * d.y};
            for (size_t k = 0; k < 9; ++k) sum[k] += light * basis[k];
        }
    }
    // The norm of each basis function, and the factor of the cosine lobe by order: 1, 2/3, 1/4.
    constexpr double kPi4 = 4 * double{kPi};
    const double share[9] = {1 / kPi4,      2 / kPi4,      2 / kPi4,      2 / kPi4,      15 / kPi4 / 4,
                             15 / kPi4 / 4, 5 / kPi4 / 16, 15 / kPi4 / 4, 15 / kPi4 / 16};
    std::array<vec4, 9> out;
    for (size_t k = 0; k < 9; ++k) out[k] = vec4(vec3(sum[k] * share[k]), 0.0F);
    return out;
}

Environment prefiltered(const HdrImage& from) {
    Environment made;
    made.width = kNarrowest;
    while (2 * made.width <= std::min(from.width, kWidest)) made.width *= 2;
    Picture level = shrunk({from.width, from.height, from.texels}, made.width, made.width / 2);
    made.mips.push_back(level.texels);
    for (int width = made.width / 2; width > 0; width /= 2) {
        level = shrunk(blurred(level), width, std::max(width / 2, 1));
        made.mips.push_back(level.texels);
    }
    made.matte = matteLight(from);
    return made;
}

namespace {

// Must be changed with every change of the algorithm, so that old cache entries are not used.
constexpr std::string_view kMaker = "surroundings 1";

// The cache key: everything that the result depends on.
std::string keyOf(const HdrImage& image) {
    return fmt::format("{}, {} x {}, {}", kMaker, image.width, image.height, hashOf(std::as_bytes(std::span(image.texels))));
}

// Must be changed with every change of makeSky().
constexpr std::string_view kSkyMaker = "sky 1";
std::string keyOf(const SkyLook& sky) {
    std::string key = fmt::format("{}, {}, {}", kMaker, kSkyMaker, sky.clouds);
    for (const vec3& v : {sky.sun, sky.sunlight, sky.horizon, sky.zenith, sky.ground}) key += fmt::format(", {} {} {}", v.x, v.y, v.z);
    return key;
}

// The cached bytes: width, mips and diffuse coefficients, one after the other.
std::vector<std::byte> bytesOf(const Environment& made) {
    std::vector<std::byte> bytes;
    const auto add = [&bytes](auto items) {
        const auto more = std::as_bytes(items);
        bytes.insert(bytes.end(), more.begin(), more.end());
    };
    add(std::span(&made.width, 1));
    for (const std::vector<vec3>& mip : made.mips) add(std::span(mip));
    add(std::span(made.matte));
    return bytes;
}

std::optional<Environment> environmentOf(std::span<const std::byte> bytes) {
    Environment made;
    const auto take = [&bytes](auto items) {
        const auto into = std::as_writable_bytes(items);
        if (bytes.size() < into.size()) return false;
        std::copy_n(bytes.begin(), into.size(), into.begin());
        bytes = bytes.subspan(into.size());
        return true;
    };
    if (!take(std::span(&made.width, 1)) || made.width < kNarrowest || made.width > kWidest) return std::nullopt;
    for (int width = made.width; width > 0; width /= 2) {
        made.mips.emplace_back(static_cast<size_t>(width) * static_cast<size_t>(std::max(width / 2, 1)));
        if (!take(std::span(made.mips.back()))) return std::nullopt;
    }
    if (!take(std::span(made.matte)) || !bytes.empty()) return std::nullopt;
    return made;
}

}  // namespace

namespace {

template <class Make>
Environment cached(const std::string& key, const DiskCache& cache, const Make& make) {
    if (const auto kept = cache.find(key))
        if (std::optional<Environment> made = environmentOf(*kept)) return std::move(*made);
    Environment made = prefiltered(make());
    cache.keep(key, bytesOf(made));
    return made;
}

}  // namespace

Environment cachedEnvironment(const HdrImage& from, const DiskCache& cache) {
    return cached(keyOf(from), cache, [&]() -> const HdrImage& { return from; });
}

Environment cachedEnvironment(const SkyLook& sky, const DiskCache& cache) {
    return cached(keyOf(sky), cache, [&] { return makeSky(sky); });
}

Result<gpu::Texture> makeEnvironmentMap(const Environment& from) {
    Result<gpu::Texture> map =
        gpu::Texture::create({.width = from.width, .height = from.width / 2, .format = gpu::Format::rgba16f, .mips = 0});
    if (!map) return map;
    map->setSampling({.wrap = gpu::Wrap::repeat});
    for (size_t mip = 0; mip < from.mips.size(); ++mip) {
        std::vector<vec4> texels;
        texels.reserve(from.mips[mip].size());
        for (const vec3& t : from.mips[mip]) texels.emplace_back(t, 1.0F);
        map->upload(std::as_bytes(std::span(texels)), static_cast<int>(mip));
    }
    return map;
}

}  // namespace rivulet
