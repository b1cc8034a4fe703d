#include "fluid/flow/flow_mesh.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>

#include "fluid/voxel/mesh_check.h"
#include "fluid/voxel/mesh_defects.h"
#include "fluid/voxel/nearest_weights.h"

namespace rivulet {

namespace {

// Below this share of its longest edge's square, twice a triangle's area is rounding error.
constexpr double kFlat = 1.0e-6;
constexpr size_t kMostTriangles = size_t{1} << 27U;

struct Side {
    uint32_t low, high;  // places
    uint32_t triangle, edge;
    bool operator<(const Side& o) const { return low != o.low ? low < o.low : high != o.high ? high < o.high : triangle < o.triangle; }
    bool sameEdge(const Side& o) const { return low == o.low && high == o.high; }
};

bool flatAt(const FlowMesh& m, size_t t) {
    double longest = 0;
    for (size_t k = 0; k < 3; ++k) {
        const dvec3 e = dvec3(m.rest[m.corner[3 * t + (k + 1) % 3]]) - dvec3(m.rest[m.corner[3 * t + k]]);
        longest = std::max(longest, glm::dot(e, e));
    }
    return glm::length(restNormal(m, t)) <= kFlat * longest;
}

// From place `low` to `high`, or the other way.
bool runsUp(const FlowMesh& m, const Side& s) { return m.corner[3 * s.triangle + s.edge] == s.low; }

void join(FlowMesh& m, const Side& a, const Side& b) {
    m.across[3 * a.triangle + a.edge] = 4 * b.triangle + b.edge;
    m.across[3 * b.triangle + b.edge] = 4 * a.triangle + a.edge;
}

// Joins the pair of opposite sides that bends least, until there is none.
void joinBranched(FlowMesh& m, std::vector<Side> sides) {
    while (sides.size() >= 2) {
        double best = -2;
        std::array<size_t, 2> who{};
        for (size_t i = 0; i < sides.size(); ++i)
            for (size_t k = i + 1; k < sides.size(); ++k) {
                if (runsUp(m, sides[i]) == runsUp(m, sides[k])) continue;
                const dvec3 a = restNormal(m, sides[i].triangle), b = restNormal(m, sides[k].triangle);
                const double along = glm::dot(a, b) / std::max(glm::length(a) * glm::length(b), 1.0e-300);
                if (along > best + 1.0e-9) {
                    best = along;
                    who = {i, k};
                }
            }
        if (best < -1.5) return;
        join(m, sides[who[0]], sides[who[1]]);
        sides.erase(sides.begin() + static_cast<std::ptrdiff_t>(who[1]));
        sides.erase(sides.begin() + static_cast<std::ptrdiff_t>(who[0]));
    }
}

void findNeighbours(FlowMesh& m) {
    std::vector<Side> sides;
    sides.reserve(m.corner.size());
    for (uint32_t t = 0; t < m.triangleCount(); ++t)
        for (uint32_t k = 0; k < 3; ++k) {
            const uint32_t from = m.corner[3 * t + k], to = m.corner[3 * t + (k + 1) % 3];
            sides.push_back({std::min(from, to), std::max(from, to), t, k});
        }
    std::sort(sides.begin(), sides.end());
    m.across.assign(m.corner.size(), FlowMesh::kOpen);
    for (size_t first = 0; first < sides.size();) {
        size_t end = first + 1;
        while (end < sides.size() && sides[end].sameEdge(sides[first])) ++end;
        if (end - first == 1)
            ++m.report.openEdges;
        else if (end - first > 2) {
            ++m.report.branchedEdges;
            joinBranched(m, {sides.begin() + static_cast<std::ptrdiff_t>(first), sides.begin() + static_cast<std::ptrdiff_t>(end)});
        } else if (runsUp(m, sides[first]) == runsUp(m, sides[first + 1]))
            ++m.report.oneSided;
        else
            join(m, sides[first], sides[first + 1]);
        first = end;
    }
}

// The mesh's position at each place: cleanMesh keeps their values, and turns or rotates no triangle's set of them.
std::vector<uint32_t> givenOf(const FlowMesh& m, const MeshView& mesh) {
    std::vector<uint32_t> given(m.rest.size(), UINT32_MAX);
    for (size_t t = 0; t < m.triangleCount(); ++t)
        for (size_t k = 0; k < 3; ++k) {
            const uint32_t place = m.corner[3 * t + k];
            for (size_t c = 0; c < 3; ++c) {
                const uint32_t index = mesh.indices[3 * size_t{m.source[t]} + c];
                if (mesh.positions[index] == m.rest[place]) given[place] = std::min(given[place], index);
            }
        }
    return given;
}

}  // namespace

std::string FlowMeshReport::sentence() const {
    std::vector<std::string> said;
    const auto say = [&said](size_t n, const char* one, const char* many, const char* done) {
        if (n > 0) said.push_back(fmt::format("{} {} ({})", n, n == 1 ? one : many, done));
    };
    say(degenerate, "face with two corners at one place", "faces with two corners at one place", "left out");
    say(repeated, "repeated face", "repeated faces", "left out");
    say(flat, "face without area", "faces without area", "drops pass through");
    say(turned, "face turned against its neighbours", "faces turned against their neighbours", "turned back");
    say(branchedEdges, "edge of three or more faces", "edges of three or more faces", "drops go on where it bends least");
    say(oneSided, "edge where the skin's two sides meet", "edges where the skin's two sides meet", "drops drip off");
    say(openEdges, "open edge", "open edges", "drops drip off");
    return said.empty() ? "" : fmt::format("The skin has {}.", fmt::join(said, ", "));
}

Result<FlowMesh> makeFlowMesh(const MeshView& mesh) {
    if (std::optional<Error> wrong = checkMeshes(std::span(&mesh, 1))) return *wrong;
    if (mesh.triangleCount() > kMostTriangles)
        return badInput(
            fmt::format("the mesh has {} triangles, a skin may have {}: give a coarser one", mesh.triangleCount(), kMostTriangles));
    CleanMesh clean = cleanMesh(std::span(&mesh, 1));
    FlowMesh m;
    m.rest = std::move(clean.positions);
    m.corner = std::move(clean.indices);
    m.source = std::move(clean.source);
    const MeshDefects& d = clean.defects;
    m.report = {.triangles = d.triangles,
                .degenerate = d.degenerateFaces,
                .repeated = d.duplicateFaces,
                .turned = d.flippedFaces,
                .components = d.components};
    for (size_t t = 0; t < m.triangleCount(); ++t) m.report.flat += flatAt(m, t) ? 1 : 0;
    if (m.report.flat == m.triangleCount()) return badInput("the mesh has no triangle with an area: nothing can flow on it");
    findNeighbours(m);
    m.given = givenOf(m, mesh);
    return m;
}

vec3 positionOf(const FlowMesh& m, const SkinPoint& at) {
    const uint32_t* c = &m.corner[3 * size_t{at.triangle}];
    return (1 - at.b1 - at.b2) * m.rest[c[0]] + at.b1 * m.rest[c[1]] + at.b2 * m.rest[c[2]];
}

SkinPoint nearestPoint(const FlowMesh& m, const vec3& x) { return nearestPoint(m, m.rest, x); }

SkinPoint nearestPoint(const FlowMesh& m, std::span<const vec3> places, const vec3& given) {
    const dvec3 x(given);
    SkinPoint best;
    double nearest = std::numeric_limits<double>::max();
    for (uint32_t t = 0; t < m.triangleCount(); ++t) {
        const dvec3 a(places[m.corner[3 * t]]), b(places[m.corner[3 * t + 1]]), c(places[m.corner[3 * t + 2]]);
        const std::array<double, 3> w = nearestWeights(x, a, b, c);
        const dvec3 apart = w[0] * a + w[1] * b + w[2] * c - x;
        const double d = glm::dot(apart, apart);
        if (d >= nearest || flatAt(m, t)) continue;  // no drop stays on one without area
        nearest = d;
        best = {t, static_cast<float>(w[1]), static_cast<float>(w[2])};
    }
    return best;
}

}  // namespace rivulet
