#include "engine/render/skin_tables.h"

#include <algorithm>
#include <cmath>

namespace rivulet {
namespace {

constexpr int kCosines = 64, kSpreads = 32;
constexpr int kPoreTexels = 512;

// The profile of Burley 2015, "Extending the Disney BRDF to a BSDF with integrated subsurface scattering", times the distance, so that it
// is finite at 0.
double profileTimesDistance(double distance, double spread) {
    return (std::exp(-distance / spread) + std::exp(-distance / (3 * spread))) / (8 * double{kPi} * spread);
}

float returned(double cosine, double spread) {
    constexpr int kRings = 48, kAround = 24;
    const double sine = std::sqrt(std::max(1 - cosine * cosine, 0.0));
    double sum = 0, weights = 0;
    for (int i = 0; i < kRings; ++i) {
        const double x = (i + 0.5) / kRings, angle = double{kPi} * x * x, width = 2 * x;  // finer near the point
        const double chord = 2 * std::sin(angle / 2);
        const double weight = profileTimesDistance(chord, spread) / std::max(chord, 1e-9) * std::sin(angle) * width;
        double ring = 0;
        for (int k = 0; k < kAround; ++k) {
            const double turn = 2 * double{kPi} * (k + 0.5) / kAround;
            ring += std::max(cosine * std::cos(angle) + sine * std::sin(angle) * std::cos(turn), 0.0);
        }
        sum += weight * ring / kAround;
        weights += weight;
    }
    return static_cast<float>(sum / weights);
}

struct Random {
    uint32_t state;
    float next() {
        state = state * 1664525U + 1013904223U;
        return static_cast<float>(state >> 8U) / 16777216.0F;
    }
};

// Jittered points on a torus of `cells` x `cells`, for the distance to the nearest and to the border between two.
class Cells {
  public:
    Cells(int cells, uint32_t seed) : cells_(cells), points_(static_cast<size_t>(cells) * static_cast<size_t>(cells)) {
        Random random{seed};
        for (vec3& p : points_) {
            p.x = random.next();
            p.y = random.next();
            p.z = random.next();
        }
    }
    // Distance to the nearest point and to the border, in cells, and the nearest's own number 0..1.
    vec3 at(vec2 uv) const {
        const vec2 x = uv * static_cast<float>(cells_);
        const ivec2 home(glm::floor(x));
        float nearest = 9, second = 9, own = 0;
        for (int j = -1; j <= 1; ++j)
            for (int i = -1; i <= 1; ++i) {
                const int cx = (home.x + i + cells_) % cells_, cy = (home.y + j + cells_) % cells_;
                const vec3& p = points_[static_cast<size_t>(cy * cells_ + cx)];
                const float d = glm::length(vec2(home) + vec2(i, j) + vec2(p.x, p.y) - x);
                if (d < nearest) {
                    second = nearest;
                    nearest = d;
                    own = p.z;
                } else {
                    second = std::min(second, d);
                }
            }
        return {nearest, second - nearest, own};
    }

  private:
    int cells_;
    std::vector<vec3> points_;
};

float smooth(float low, float high, float x) {
    const float t = std::clamp((x - low) / (high - low), 0.0F, 1.0F);
    return t * t * (3 - 2 * t);
}

}  // namespace

Result<gpu::Texture> makeDiffusionTable() {
    Result<gpu::Texture> table = gpu::Texture::create({.width = kCosines, .height = kSpreads, .format = gpu::Format::r16f});
    if (!table) return table;
    std::vector<float> texels;
    for (int y = 0; y < kSpreads; ++y)
        for (int x = 0; x < kCosines; ++x)
            texels.push_back(returned(2.0 * (x + 0.5) / kCosines - 1.0, std::max((y + 0.5) / kSpreads - 0.5 / kSpreads, 1e-3)));
    table->upload(std::as_bytes(std::span(texels)));
    return table;
}

Result<gpu::Texture> makeSlopes(const Image& heights, float step, bool repeats) {
    Result<gpu::Texture> made =
        gpu::Texture::create({.width = heights.width, .height = heights.height, .format = gpu::Format::rgba16f, .mips = 0});
    if (!made) return made;
    const int w = heights.width, h = heights.height;
    auto at = [&](int x, int y) {
        x = repeats ? (x + w) % w : std::clamp(x, 0, w - 1);
        y = repeats ? (y + h) % h : std::clamp(y, 0, h - 1);
        return (static_cast<float>(heights.rgba[4 * (static_cast<size_t>(y) * static_cast<size_t>(w) + static_cast<size_t>(x))]) - 128.0F) *
               step;
    };
    std::vector<vec4> texels;
    texels.reserve(static_cast<size_t>(w) * static_cast<size_t>(h));
    for (int y = 0; y < h; ++y)
        for (int x = 0; x < w; ++x) {
            // Sobel's differences: a single-texel one shows the grid.
            const float du =
                (at(x + 1, y + 1) - at(x - 1, y + 1) + 2 * (at(x + 1, y) - at(x - 1, y)) + at(x + 1, y - 1) - at(x - 1, y - 1)) *
                (0.125F * static_cast<float>(w));
            const float dv =
                (at(x + 1, y + 1) - at(x + 1, y - 1) + 2 * (at(x, y + 1) - at(x, y - 1)) + at(x - 1, y + 1) - at(x - 1, y - 1)) *
                (0.125F * static_cast<float>(h));
            texels.emplace_back(du, dv, du * du + dv * dv, 1000.0F * at(x, y));
        }
    made->upload(std::as_bytes(std::span(texels)));
    made->generateMips();
    made->setSampling(
        {.mip = repeats ? gpu::Filter::linear : gpu::Filter::nearest, .wrap = repeats ? gpu::Wrap::repeat : gpu::Wrap::clamp});
    return made;
}

Image makePores() {
    Image image{"pores", kPoreTexels, kPoreTexels, {}};
    image.rgba.resize(size_t{4} * kPoreTexels * kPoreTexels);
    const Cells fields(44, 1), coarse(19, 2), pits(17, 3);  // a network of fine lines, one of deeper ones, pores
    for (int y = 0; y < kPoreTexels; ++y)
        for (int x = 0; x < kPoreTexels; ++x) {
            const vec2 uv((static_cast<float>(x) + 0.5F) / kPoreTexels, (static_cast<float>(y) + 0.5F) / kPoreTexels);
            const vec3 fine = fields.at(uv), deep = coarse.at(uv), pit = pits.at(uv);
            float height =
                0.30F * smooth(0.0F, 0.5F, fine.y) * (0.4F + 1.2F * fine.z) + 0.45F * smooth(0.0F, 0.4F, deep.y) * (0.5F + deep.z);
            const float radius = 0.10F + 0.12F * pit.z;
            height -= (0.5F + 0.9F * pit.z) * (1.0F - smooth(0.2F * radius, radius, pit.x));
            const auto level = static_cast<uint8_t>(std::clamp(128.0F + 48.0F * (height - 0.6F), 0.0F, 255.0F));
            for (size_t k = 0; k < 4; ++k)
                image.rgba[4 * (static_cast<size_t>(y) * kPoreTexels + static_cast<size_t>(x)) + k] = k == 3 ? 255 : level;
        }
    return image;
}

}  // namespace rivulet
