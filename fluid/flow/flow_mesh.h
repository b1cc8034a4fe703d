// FlowMesh: the triangles that drops walk on, cleaned, each with its neighbours. It needs no UVs.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "engine/core/mesh_view.h"
#include "engine/core/result.h"

namespace rivulet {

// Faults of a mesh, which are repaired or avoided. sentence() is "" if there are none.
struct FlowMeshReport {
    size_t triangles = 0;      // as given
    size_t degenerate = 0;     // two corners at one place: left out
    size_t repeated = 0;       // the same face again: left out
    size_t flat = 0;           // three corners on a line: drops pass through and do not stay
    size_t turned = 0;         // wound against its neighbours: reversed
    size_t openEdges = 0;      // of one triangle: drops that reach them drip off
    size_t branchedEdges = 0;  // of three and more triangles: the pair that bends least is connected
    size_t oneSided = 0;       // edges where the two sides of the skin meet, as on a Moebius strip: treated as open
    size_t components = 0;     // connected through edges
    std::string sentence() const;
};

struct FlowMesh {
    static constexpr uint32_t kOpen = UINT32_MAX;

    std::vector<vec3> rest;        // m, of each place: positions that are equal are one place
    std::vector<uint32_t> given;   // of each place: the first of the mesh's positions there
    std::vector<uint32_t> corner;  // 3 a triangle: places, counter-clockwise seen from outside
    // 3 a triangle. Edge k runs from corner k to corner (k + 1) % 3; the value is 4 * the triangle across + its edge, or kOpen.
    std::vector<uint32_t> across;
    std::vector<uint32_t> source;  // of each triangle: its number in the input mesh
    FlowMeshReport report;

    size_t triangleCount() const { return source.size(); }
};

// Normal of triangle `t` at rest; its length is twice the area, m^2.
inline dvec3 restNormal(const FlowMesh& m, size_t t) {
    const dvec3 a(m.rest[m.corner[3 * t]]), b(m.rest[m.corner[3 * t + 1]]), c(m.rest[m.corner[3 * t + 2]]);
    return glm::cross(b - a, c - a);
}

// Error (badInput): indices out of range or not in threes, positions that are not finite, no triangle with an area, more than 2^27 of them.
Result<FlowMesh> makeFlowMesh(const MeshView& mesh);

// A point on a skin: a triangle and the barycentric coordinates of its corners 1 and 2; that of corner 0 is 1 - b1 - b2.
struct SkinPoint {
    uint32_t triangle = 0;
    float b1 = 0, b2 = 0;
};
vec3 positionOf(const FlowMesh& mesh, const SkinPoint& at);  // m, at rest

// The point of the skin nearest to `x` (m, at rest; or as the skin is bent: `places` m, of each of the mesh's). Tests every triangle.
SkinPoint nearestPoint(const FlowMesh& mesh, const vec3& x);
SkinPoint nearestPoint(const FlowMesh& mesh, std::span<const vec3> places, const vec3& x);

}  // namespace rivulet
