// Skins to flow on, for tests.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "fluid/flow/surface_flow.h"

namespace rivulet {

struct Shape {
    std::vector<vec3> positions;
    std::vector<uint32_t> indices;
    MeshView view() const { return {positions, indices, {}, {}}; }
};

// A sheet of n x m quads in the plane of `across` and `along`, from `corner`; its normal is across x along.
inline Shape sheet(const vec3& corner, const vec3& across, const vec3& along, uint32_t n, uint32_t m) {
    Shape s;
    for (uint32_t k = 0; k <= m; ++k)
        for (uint32_t i = 0; i <= n; ++i)
            s.positions.push_back(corner + across * (static_cast<float>(i) / static_cast<float>(n)) +
                                  along * (static_cast<float>(k) / static_cast<float>(m)));
    for (uint32_t k = 0; k < m; ++k)
        for (uint32_t i = 0; i < n; ++i) {
            const uint32_t a = k * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
            // Quads are cut one way and the other.
            if ((i + k) % 2 == 0)
                s.indices.insert(s.indices.end(), {a, b, d, a, d, c});
            else
                s.indices.insert(s.indices.end(), {a, b, c, b, d, c});
        }
    return s;
}

// A ball of `rows` x 2 `rows` quads, poles closed by triangles, with a seam of double vertices.
inline Shape ball(float radius, uint32_t rows) {
    Shape s;
    const uint32_t around = 2 * rows;
    for (uint32_t k = 0; k <= rows; ++k)
        for (uint32_t i = 0; i <= around; ++i) {
            const double t = std::numbers::pi * k / rows, f = 2 * std::numbers::pi * (i % around) / around;
            const double sine = k == 0 || k == rows ? 0 : std::sin(t);
            s.positions.push_back(radius * vec3(dvec3(sine * std::cos(f), std::cos(t), -sine * std::sin(f))));
        }
    for (uint32_t k = 0; k < rows; ++k)
        for (uint32_t i = 0; i < around; ++i) {
            const uint32_t a = k * (around + 1) + i, b = a + 1, c = a + around + 1, d = c + 1;
            s.indices.insert(s.indices.end(), {a, c, d, a, d, b});  // two of a pole's have no area
        }
    return s;
}

inline SurfaceFlow flowOn(Device& device, const Shape& shape, const SurfaceFlowParams& params = {}) {
    Result<FlowMesh> mesh = makeFlowMesh(shape.view());
    EXPECT_TRUE(mesh) << (mesh ? "" : mesh.error().message);
    Result<SurfaceFlow> flow = SurfaceFlow::create(device, std::move(*mesh), params);
    EXPECT_TRUE(flow) << (flow ? "" : flow.error().message);
    return std::move(*flow);
}

}  // namespace rivulet
