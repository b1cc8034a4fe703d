#include "fluid/scene/face_features.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace rivulet {

namespace {

// Of the width of an eye: how far its inner corner lies beyond what is seen to be open.
constexpr float kHiddenCorner = 0.1F;

// Heights over a strip along the middle of a face, from above the eyes to below the chin.
struct Profile {
    std::vector<float> z;
    float low = 0, step = 1;
    float yAt(size_t k) const { return low + (static_cast<float>(k) + 0.5F) * step; }
};

Profile profileOf(const ViewFrame& frame, const std::vector<vec3>& skin, float halfWidth, float low, float high, float step) {
    const int tall = static_cast<int>((high - low) / step), wide = static_cast<int>(2 * halfWidth / step);
    const DepthMap map(frame, skin, vec2(-halfWidth, low), wide, tall, step);
    Profile p{{}, low, step};
    for (int y = 0; y < tall; ++y) {
        float most = DepthMap::kNothing;
        for (int x = 0; x < map.width(); ++x) most = std::max(most, map.at(x, y));
        p.z.push_back(most);
    }
    return p;
}

}  // namespace

std::optional<Opening> openingAt(const ViewFrame& frame, const std::vector<vec3>& skin, float radius, bool ball, float apart) {
    constexpr int kPerRadius = 48;
    constexpr float kWide = 2.2F, kHigh = 1.8F;  // radii, half the window
    constexpr float kDeep = 0.25F;               // radii before the centre: what lies deeper is no lid
    const int w = static_cast<int>(2 * kWide * kPerRadius), h = static_cast<int>(2 * kHigh * kPerRadius);
    const float step = radius / kPerRadius;
    const DepthMap map(frame, skin, -radius * vec2(kWide, kHigh), w, h, step);
    const auto isOpen = [&](int x, int y) {
        const vec2 p = map.middleOf(x, y);
        const float under = radius * radius - glm::dot(p, p);
        return map.at(x, y) < std::max(kDeep * radius, ball && under > 0 ? std::sqrt(under) : 0.0F);
    };
    // From the open texel nearest to the centre.
    ivec2 seed(-1);
    float nearest = 0.8F * radius;
    for (int y = 0; y < h; ++y)
        for (int x = 0; x < w; ++x)
            if (const float d = glm::length(map.middleOf(x, y)); d < nearest && isOpen(x, y)) {
                nearest = d;
                seed = ivec2(x, y);
            }
    if (seed.x < 0) return std::nullopt;
    std::vector<uint8_t> taken(static_cast<size_t>(w) * static_cast<size_t>(h), 0);
    const auto index = [](int x, int y) { return static_cast<size_t>(y) * static_cast<size_t>(w) + static_cast<size_t>(x); };
    std::vector<ivec2> open{seed};
    taken[index(seed.x, seed.y)] = 1;
    std::vector<ivec2> span(static_cast<size_t>(w), ivec2(h, -1));  // of each column: the lowest and highest open texel
    int first = w, last = -1;
    while (!open.empty()) {
        const ivec2 at = open.back();
        open.pop_back();
        if (at.x == 0 || at.y == 0 || at.x == w - 1 || at.y == h - 1) return std::nullopt;  // no skin about it
        ivec2& s = span[static_cast<size_t>(at.x)];
        s = ivec2(std::min(s.x, at.y), std::max(s.y, at.y));
        first = std::min(first, at.x);
        last = std::max(last, at.x);
        for (const ivec2& d : {ivec2(1, 0), ivec2(-1, 0), ivec2(0, 1), ivec2(0, -1)}) {
            const ivec2 next = at + d;
            if (taken[index(next.x, next.y)] != 0 || !isOpen(next.x, next.y)) continue;
            taken[index(next.x, next.y)] = 1;
            open.push_back(next);
        }
    }
    if (last - first < kPerRadius * 3 / 4) return std::nullopt;  // closed, or a slit
    // The skin from a texel of its edge on, `way` by `way`.
    const auto skinFrom = [&](int x, int y, const ivec2& way) {
        float z = kDeep * radius;
        for (int k = 0; k < 8; ++k)
            if (const float there = map.at(x + k * way.x, y + k * way.y); there > kDeep * radius) {
                z = there;
                break;
            }
        return z;
    };
    Opening o;
    const auto corner = [&](int column, int side) {
        const ivec2 s = span[static_cast<size_t>(column)];
        const int y = (s.x + s.y) / 2;
        const vec2 p = map.middleOf(column, y) + vec2(0.5F * static_cast<float>(side) * step, 0);
        return vec3(p, skinFrom(column + side, y, ivec2(side, 0)));
    };
    std::vector<vec3> lower;
    lower.push_back(corner(first, -1));
    for (int x = first; x <= last; ++x) {
        const int y = span[static_cast<size_t>(x)].x;
        lower.emplace_back(map.middleOf(x, y) - vec2(0, 0.5F * step), skinFrom(x, y - 1, ivec2(0, -1)));
    }
    lower.push_back(corner(last, 1));
    for (int pass = 0; pass < 8; ++pass) {  // the texels' steps
        std::vector<vec3> smooth = lower;
        for (size_t k = 1; k + 1 < lower.size(); ++k) smooth[k] = 0.25F * lower[k - 1] + 0.5F * lower[k] + 0.25F * lower[k + 1];
        lower = smooth;
    }
    for (size_t k = 0; k < kLidPoints; ++k) {
        const float at = static_cast<float>(k) / (kLidPoints - 1) * static_cast<float>(lower.size() - 1);
        const auto before = std::min(static_cast<size_t>(at), lower.size() - 2);
        o.lower.push_back(frame.back(glm::mix(lower[before], lower[before + 1], at - static_cast<float>(before))));
    }
    o.outer = o.lower.back();
    // The corner with its flesh lies beyond what is seen to be open.
    vec3 inner = lower.front();
    inner.x -= kHiddenCorner * (lower.back().x - lower.front().x);
    if (const float z = map.over(vec2(inner)); z > kDeep * radius) inner.z = z;
    o.inner = frame.back(inner);
    const vec3 tear = inner + apart * vec3(kTearOut, -kTearDown, 0);
    const float z = map.over(vec2(tear));
    o.tear = frame.back(vec3(vec2(tear), z > kDeep * radius ? z : tear.z));
    return o;
}

NoseAndChin noseAndChin(const ViewFrame& frame, const std::vector<vec3>& skin, float d, float cornerZ) {
    const Profile p = profileOf(frame, skin, 0.12F * d, -2.7F * d, 1.5F * d, d / 80);
    NoseAndChin found;
    float brow = DepthMap::kNothing;
    size_t tip = p.z.size();
    for (size_t k = 0; k < p.z.size(); ++k) {
        const float y = p.yAt(k) / d;
        if (y > 0.2F && y < 1.0F) brow = std::max(brow, p.z[k]);
        if (y > -1.0F && y < -0.1F && (tip == p.z.size() || p.z[k] > p.z[tip])) tip = k;
    }
    if (tip == p.z.size() || !std::isfinite(p.z[tip])) return found;
    found.prominence = (p.z[tip] - std::max(cornerZ, brow)) / d;
    if (found.prominence < 0.05F) return found;
    found.nose = vec3(0, p.yAt(tip), p.z[tip]);
    // The chin comes forward below the mouth; its lowest point is where the front steps back, or ends.
    float most = DepthMap::kNothing;
    for (size_t k = p.z.size(); k-- > 0;) {
        const float y = p.yAt(k) / d;
        if (y > -1.3F) continue;
        if (y > -2.2F) most = std::max(most, p.z[k]);
        if (!std::isfinite(most)) continue;
        if (p.z[k] < most - 0.3F * d) break;
        found.chin = vec3(0, p.yAt(k), p.z[k]);
    }
    return found;
}

}  // namespace rivulet
