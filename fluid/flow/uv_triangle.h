// A triangle laid out in UV, and the texels whose centres lie in it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "engine/core/math.h"

namespace rivulet {

inline double cross2(const dvec2& a, const dvec2& b) { return a.x * b.y - a.y * b.x; }

// Corners in texels, so that texels' centres are at whole numbers; moved by whole maps so that the least u and v are in 0 to 1.
struct UvTriangle {
    enum class Fault { none, notNumbers, tooWide, noArea };
    std::array<dvec2, 3> p{};
    double area = 0;  // twice it, negative where mirrored
    Fault fault = Fault::none;
    bool good() const { return fault == Fault::none; }
    dvec2 middle() const { return (p[0] + p[1] + p[2]) / 3.0; }
    dvec2 low() const { return glm::min(p[0], glm::min(p[1], p[2])); }
    dvec2 high() const { return glm::max(p[0], glm::max(p[1], p[2])); }
};

// `uv`: its three corners; `size`: texels of the map's edge.
inline UvTriangle uvTriangle(std::span<const vec2> uv, int size) {
    UvTriangle t;
    for (size_t k = 0; k < 3; ++k) {
        t.p[k] = dvec2(uv[k]);
        if (!(std::abs(t.p[k].x) <= 1.0e5 && std::abs(t.p[k].y) <= 1.0e5)) t.fault = UvTriangle::Fault::notNumbers;
    }
    if (!t.good()) return t;
    const dvec2 low = t.low(), span = t.high() - low;
    if (span.x > 1 || span.y > 1) t.fault = UvTriangle::Fault::tooWide;
    for (dvec2& p : t.p) p = (p - glm::floor(low)) * double(size) - 0.5;
    t.area = cross2(t.p[1] - t.p[0], t.p[2] - t.p[0]);
    double longest = 0;
    for (size_t k = 0; k < 3; ++k) longest = std::max(longest, glm::distance(t.p[k], t.p[(k + 1) % 3]));
    // Thinner than a hundredth of a texel: its map from UV is rounding.
    if (t.good() && (std::abs(t.area) <= 1.0e-2 * longest || std::abs(t.area) <= 1.0e-4)) t.fault = UvTriangle::Fault::noArea;
    return t;
}

// see(x, y) for every centre in the triangle. `loose`: how far beyond an edge still counts, of the triangle's height over it; less than 0:
// centres on an edge do not.
template <class F>
void eachCentre(const UvTriangle& t, double loose, F&& see) {
    const double sign = t.area > 0 ? 1 : -1, least = -loose * std::abs(t.area);
    const dvec2 low = t.low(), high = t.high();
    const int x0 = static_cast<int>(std::ceil(low.x - 1.0e-6)), x1 = static_cast<int>(std::floor(high.x + 1.0e-6));
    const int y1 = static_cast<int>(std::floor(high.y + 1.0e-6));
    for (int y = static_cast<int>(std::ceil(low.y - 1.0e-6)); y <= y1; ++y)
        for (int x = x0; x <= x1; ++x) {
            bool in = true;
            for (size_t k = 0; k < 3 && in; ++k) in = sign * cross2(t.p[(k + 1) % 3] - t.p[k], dvec2(x, y) - t.p[k]) >= least;
            if (in) see(x, y);
        }
}

}  // namespace rivulet
