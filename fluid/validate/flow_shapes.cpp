#include "fluid/validate/flow_shapes.h"

#include <algorithm>
#include <cmath>

namespace rivulet {

namespace {

// Quads (k, i) of a grid of (n + 1) x (m + 1) vertices, split along alternating diagonals.
void addQuads(Shape& s, uint32_t n, uint32_t m) {
    for (uint32_t k = 0; k < m; ++k)
        for (uint32_t i = 0; i < n; ++i) {
            const uint32_t a = k * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
            if ((i + k) % 2 == 0)
                s.indices.insert(s.indices.end(), {a, b, d, a, d, c});
            else
                s.indices.insert(s.indices.end(), {a, b, c, b, d, c});
        }
}

}  // namespace

Shape sheetShape(const vec3& corner, const vec3& across, const vec3& along, uint32_t n, uint32_t m) {
    Shape s;
    for (uint32_t k = 0; k <= m; ++k)
        for (uint32_t i = 0; i <= n; ++i) {
            const vec2 uv(static_cast<float>(i) / static_cast<float>(n), static_cast<float>(k) / static_cast<float>(m));
            s.positions.push_back(corner + across * uv.x + along * uv.y);
            s.uvs.push_back(uv);
        }
    addQuads(s, n, m);
    return s;
}

Shape ballShape(float radius, uint32_t rows) {
    Shape s;
    const uint32_t around = 2 * rows;
    for (uint32_t k = 0; k <= rows; ++k)
        for (uint32_t i = 0; i <= around; ++i) {
            const double t = kPiD * k / rows, f = 2 * kPiD * (i % around) / around;
            const double sine = k == 0 || k == rows ? 0 : std::sin(t);
            s.positions.push_back(radius * vec3(dvec3(sine * std::cos(f), std::cos(t), -sine * std::sin(f))));
            s.uvs.emplace_back(static_cast<double>(i) / around, 1 - static_cast<double>(k) / rows);
        }
    for (uint32_t k = 0; k < rows; ++k)
        for (uint32_t i = 0; i < around; ++i) {
            const uint32_t a = k * (around + 1) + i, b = a + 1, c = a + around + 1, d = c + 1;
            s.indices.insert(s.indices.end(), {a, c, d, a, d, b});  // at a pole one of the two has no area
        }
    return s;
}

Shape coneShape(float low, float high, float height, uint32_t around, uint32_t rows) {
    Shape s;
    for (uint32_t k = 0; k <= rows; ++k)
        for (uint32_t i = 0; i <= around; ++i) {
            const double v = 1 - static_cast<double>(k) / rows, f = 2 * kPiD * (i % around) / around;
            const double r = double{low} + (double{high} - double{low}) * v;
            s.positions.emplace_back(dvec3(r * std::cos(f), double{height} * v, -r * std::sin(f)));
            s.uvs.emplace_back(static_cast<double>(i) / around, v);
        }
    for (uint32_t k = 0; k < rows; ++k)
        for (uint32_t i = 0; i < around; ++i) {
            const uint32_t a = k * (around + 1) + i, b = a + 1, c = a + around + 1, d = c + 1;
            s.indices.insert(s.indices.end(), {a, c, d, a, d, b});
        }
    return s;
}

Shape laidOut(const Shape& shape, Layout layout) {
    if (layout == Layout::own) return shape;
    Shape s = shape;
    if (layout == Layout::stretched)
        for (vec2& uv : s.uvs) uv = vec2(uv.x * (0.4F + 0.6F * uv.x), 0.25F * uv.y);
    if (layout == Layout::turned) {
        const float c = std::cos(0.7F), n = std::sin(0.7F);
        for (vec2& uv : s.uvs) uv = vec2(0.5F) + 0.65F * vec2(c * (uv.x - 0.5F) - n * (uv.y - 0.5F), n * (uv.x - 0.5F) + c * (uv.y - 0.5F));
        // Every third triangle first, with rotated corners.
        std::vector<uint32_t> order;
        const size_t triangles = shape.indices.size() / 3;
        for (size_t first = 0; first < 3; ++first)
            for (size_t t = first; t < triangles; t += 3)
                for (size_t k = 0; k < 3; ++k) order.push_back(shape.indices[3 * t + (k + t) % 3]);
        s.indices = order;
    }
    if (layout == Layout::pieces) {
        s = {};
        constexpr float kAcross = 4;
        for (size_t t = 0; t < shape.indices.size(); t += 3) {
            vec2 middle(0.0F);
            for (size_t k = 0; k < 3; ++k) middle += shape.uvs[shape.indices[t + k]] / 3.0F;
            // The square of the whole triangle; square (x, y) moves to (3 - y, x), turned by 90 degrees and slightly smaller.
            const vec2 square = glm::min(glm::floor(middle * kAcross), vec2(kAcross - 1));
            for (size_t k = 0; k < 3; ++k) {
                const uint32_t from = shape.indices[t + k];
                const vec2 within = shape.uvs[from] * kAcross - square - 0.5F;
                s.indices.push_back(static_cast<uint32_t>(s.positions.size()));
                s.positions.push_back(shape.positions[from]);
                s.uvs.push_back((vec2(kAcross - 1 - square.y, square.x) + 0.5F + 0.7F * vec2(-within.y, within.x)) / kAcross);
            }
        }
    }
    return s;
}

const char* layoutName(Layout layout) {
    switch (layout) {
        case Layout::own:
            return "own";
        case Layout::stretched:
            return "stretched";
        case Layout::turned:
            return "turned";
        case Layout::pieces:
            return "in pieces";
    }
    return "";
}

}  // namespace rivulet
