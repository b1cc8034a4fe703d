// Skins with charts, for tests of what is drawn and unwrapped.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "engine/core/mesh_view.h"
#include "engine/scene/import_model.h"
#include "fluid/flow/flow_mesh.h"
#include "fluid/validate/flow_shapes.h"

namespace rivulet::test {

using Skin = Shape;

// n x n quads from `corner`; UVs from `uv` along uvAcross and uvAlong.
inline void addSheet(Skin& s, const vec3& corner, const vec3& across, const vec3& along, uint32_t n, vec2 uv, vec2 uvAcross, vec2 uvAlong) {
    const auto first = static_cast<uint32_t>(s.positions.size());
    for (uint32_t k = 0; k <= n; ++k)
        for (uint32_t i = 0; i <= n; ++i) {
            const float a = static_cast<float>(i) / static_cast<float>(n), b = static_cast<float>(k) / static_cast<float>(n);
            s.positions.push_back(corner + across * a + along * b);
            s.uvs.push_back(uv + uvAcross * a + uvAlong * b);
        }
    for (uint32_t k = 0; k < n; ++k)
        for (uint32_t i = 0; i < n; ++i) {
            const uint32_t a = first + k * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
            s.indices.insert(s.indices.end(), {a, b, d, a, d, c});
        }
}

// A ball as an inflated cube: six charts of n x n quads. Points of the cube have integer coordinates, so that faces meet exactly.
inline Skin cubeBall(float radius, uint32_t n) {
    Skin s;
    const vec3 axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const auto rows = static_cast<float>(n);
    for (uint32_t f = 0; f < 6; ++f) {
        const vec3 out = axes[f / 2] * (f % 2 == 0 ? 1.0F : -1.0F), a = axes[(f / 2 + 1) % 3], b = glm::cross(out, a);
        addSheet(s, rows * (out - a - b), 2.0F * rows * a, 2.0F * rows * b, n,
                 vec2(0.02F + 0.33F * static_cast<float>(f % 3), 0.02F + 0.5F * static_cast<float>(f / 3)), vec2(0.3F, 0), vec2(0, 0.45F));
    }
    for (vec3& p : s.positions) p = radius * glm::normalize(glm::round(p));
    return s;
}

// The same triangles, each a chart of its own, two to a cell of a grid.
inline Skin shattered(const Skin& of) {
    Skin s;
    const auto cells = static_cast<uint32_t>(std::ceil(std::sqrt(static_cast<double>(of.indices.size()) / 6)));
    for (uint32_t k = 0; k < of.indices.size(); ++k) {
        const uint32_t t = k / 3, cell = t / 2;
        const vec2 corner(static_cast<float>(cell % cells), static_cast<float>(cell / cells));
        const vec2 inCell[2][3] = {{{0.08F, 0.1F}, {0.7F, 0.1F}, {0.08F, 0.72F}}, {{0.92F, 0.9F}, {0.3F, 0.9F}, {0.92F, 0.28F}}};
        s.positions.push_back(of.positions[of.indices[k]]);
        s.uvs.push_back((corner + inCell[t % 2][k % 3]) / static_cast<float>(cells));
        s.indices.push_back(k);
    }
    return s;
}

// The connected part of a mesh with the most triangles: for the head its skin, without eyes and lashes.
inline Skin largestPart(const rivulet::Mesh& mesh) {
    Result<FlowMesh> made = makeFlowMesh(mesh.view());
    if (!made) return {};
    std::vector<uint32_t> part(made->triangleCount(), UINT32_MAX), open, best;
    for (uint32_t start = 0; start < part.size(); ++start) {
        if (part[start] != UINT32_MAX) continue;
        std::vector<uint32_t> found(1, start);
        part[start] = start;
        for (size_t k = 0; k < found.size(); ++k)
            for (size_t edge = 0; edge < 3; ++edge) {
                const uint32_t across = made->across[3 * size_t{found[k]} + edge];
                if (across == FlowMesh::kOpen || part[across / 4] != UINT32_MAX) continue;
                part[across / 4] = start;
                found.push_back(across / 4);
            }
        if (found.size() > best.size()) best.swap(found);
    }
    Skin s;
    s.positions = mesh.positions;
    s.uvs = mesh.uvs;
    for (const uint32_t t : best)
        for (size_t k = 0; k < 3; ++k) s.indices.push_back(mesh.indices[3 * size_t{made->source[t]} + k]);
    return s;
}

inline Skin headSkin() {
    Result<rivulet::Mesh> head = importMesh(RIVULET_SOURCE_DIR "/assets/meshes/head/head.glb");
    return head ? largestPart(*head) : Skin{};
}

}  // namespace rivulet::test
