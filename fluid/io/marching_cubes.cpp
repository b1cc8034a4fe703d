// Lorensen & Cline 1987 "Marching cubes: a high resolution 3D surface construction algorithm".
#include "fluid/io/marching_cubes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <unordered_map>

#include "engine/core/parallel.h"

namespace rivulet {

namespace {

constexpr int kBisections = 12;   // of an edge: 2^-12 of a cell
constexpr double kCorner = 1e-3;  // cells: least distance of a vertex from an edge's ends, else triangles would have no area

// Corner k of a cell: bits 0, 1, 2 are x, y, z. An edge goes from a corner along an axis.
ivec3 cornerAt(unsigned k) { return {static_cast<int>(k & 1U), static_cast<int>(k >> 1U & 1U), static_cast<int>(k >> 2U & 1U)}; }

// The corners of each face, counter-clockwise seen from outside.
constexpr unsigned kFaces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};

// An edge of a cell by its two corners: 12 of the 24 numbers are edges.
unsigned edgeOf(unsigned a, unsigned b) {
    const unsigned axis = (a ^ b) == 1 ? 0 : (a ^ b) == 2 ? 1 : 2;
    return 8 * axis + std::min(a, b);
}

// The loops of crossings in a cell whose corners inside are the bits of `inside`; each runs counter-clockwise seen from outside the water.
struct Loops {
    std::array<std::array<unsigned, 12>, 4> edges{};
    std::array<unsigned, 4> lengths{};
    std::array<bool, 4> ambiguous{};  // it touches a face with four crossings
    unsigned count = 0;
};

Loops loopsOf(unsigned inside) {
    const auto in = [inside](unsigned corner) { return (inside >> corner & 1U) != 0; };
    std::array<unsigned, 24> next{};
    std::array<bool, 24> open{}, ambiguous{};
    for (const auto& face : kFaces) {
        unsigned crossings = 0;
        for (unsigned k = 0; k < 4; ++k) crossings += in(face[k]) != in(face[(k + 1) % 4]) ? 1 : 0;
        for (unsigned k = 0; k < 4; ++k) {
            if (in(face[k]) || !in(face[(k + 1) % 4])) continue;
            unsigned last = k + 1;  // of the run of corners inside that begins at k
            while (in(face[(last + 1) % 4])) ++last;
            const unsigned entry = edgeOf(face[k], face[(k + 1) % 4]), leaving = edgeOf(face[last % 4], face[(last + 1) % 4]);
            next[entry] = leaving;
            open[entry] = true;
            if (crossings == 4) ambiguous[entry] = ambiguous[leaving] = true;
        }
    }
    Loops loops;
    for (unsigned start = 0; start < 24; ++start) {
        if (!open[start]) continue;
        const unsigned own = loops.count++;
        for (unsigned e = start; open[e]; e = next[e]) {
            open[e] = false;
            loops.edges[own][loops.lengths[own]++] = e;
            loops.ambiguous[own] = loops.ambiguous[own] || ambiguous[e];
        }
    }
    return loops;
}

// A cell that the surface passes through.
struct Crossed {
    ivec3 cell;
    unsigned inside = 0;
};

std::vector<Crossed> crossedCells(const IsoSurface& surface, int fine) {
    const std::vector<ivec3>& coarse = surface.cells().cells();
    const double step = surface.cells().edge() / fine;
    std::vector<std::vector<Crossed>> found(coarse.size());
    const auto corners = static_cast<size_t>(fine + 1);
    parallelFor(size_t{0}, coarse.size(), [&](size_t c) {
        std::vector<uint8_t> in(corners * corners * corners);
        const ivec3 first = fine * coarse[c];
        size_t at = 0;
        for (int z = 0; z <= fine; ++z)
            for (int y = 0; y <= fine; ++y)
                for (int x = 0; x <= fine; ++x) in[at++] = surface.value(step * dvec3(first + ivec3(x, y, z))) > IsoSurface::kLevel ? 1 : 0;
        const auto one = static_cast<size_t>(std::count(in.begin(), in.end(), 1));
        if (one == 0 || one == in.size()) return;
        for (int z = 0; z < fine; ++z)
            for (int y = 0; y < fine; ++y)
                for (int x = 0; x < fine; ++x) {
                    unsigned inside = 0;
                    for (unsigned k = 0; k < 8; ++k) {
                        const ivec3 p = ivec3(x, y, z) + cornerAt(k);
                        const size_t corner =
                            (static_cast<size_t>(p.z) * corners + static_cast<size_t>(p.y)) * corners + static_cast<size_t>(p.x);
                        inside |= unsigned{in[corner]} << k;
                    }
                    if (inside != 0 && inside != 255) found[c].push_back({first + ivec3(x, y, z), inside});
                }
    });
    std::vector<Crossed> all;
    for (const auto& some : found) all.insert(all.end(), some.begin(), some.end());
    return all;
}

// A vertex on a cell's edge, named by the edge's lower end.
struct EdgeKey {
    ivec3 corner;
    unsigned axis;
    bool operator==(const EdgeKey&) const = default;
};
struct EdgeHash {
    size_t operator()(const EdgeKey& e) const {
        uint64_t h = e.axis;
        for (int k = 0; k < 3; ++k) h = (h ^ static_cast<uint32_t>(e.corner[k])) * 0x9E3779B97F4A7C15ULL;
        return h ^ h >> 32U;
    }
};

dvec3 crossingOf(const IsoSurface& surface, const EdgeKey& edge, double step) {
    const dvec3 from = step * dvec3(edge.corner);
    dvec3 along(0.0);
    along[static_cast<int>(edge.axis)] = step;
    const bool inside = surface.value(from) > IsoSurface::kLevel;
    double low = 0, high = 1;
    for (int k = 0; k < kBisections; ++k) {
        const double middle = 0.5 * (low + high);
        ((surface.value(from + middle * along) > IsoSurface::kLevel) == inside ? low : high) = middle;
    }
    return from + std::clamp(0.5 * (low + high), kCorner, 1 - kCorner) * along;
}

}  // namespace

Result<SurfaceMesh> marchingCubes(const IsoSurface& surface, int cellsPerSpacing) {
    if (cellsPerSpacing < 1 || cellsPerSpacing > kMaxCellsPerSpacing)
        return badInput(
            fmt::format("marching cubes take 1 to {} cells a spacing; {} were asked for", kMaxCellsPerSpacing, cellsPerSpacing));
    const double step = surface.cells().edge() / cellsPerSpacing;
    const std::vector<Crossed> cells = crossedCells(surface, cellsPerSpacing);
    if (cells.size() > std::numeric_limits<uint32_t>::max() / 8)
        return failed(fmt::format("the surface passes through {} cells, too many for one mesh; make them larger", cells.size()));

    SurfaceMesh mesh;
    std::unordered_map<EdgeKey, uint32_t, EdgeHash> vertexOf;
    std::vector<EdgeKey> edges;                // of each vertex; those in the middle of a cell come after them
    std::vector<std::vector<uint32_t>> rings;  // the vertices about each vertex in the middle of a cell
    constexpr uint32_t kMiddle = 0x80000000U;  // marks them until the number of edges is known
    for (const Crossed& c : cells) {
        const Loops loops = loopsOf(c.inside);
        for (unsigned l = 0; l < loops.count; ++l) {
            std::array<uint32_t, 12> ring{};
            const unsigned length = loops.lengths[l];
            for (unsigned k = 0; k < length; ++k) {
                const unsigned e = loops.edges[l][k];
                const EdgeKey key{c.cell + cornerAt(e % 8), e / 8};
                const auto [at, made] = vertexOf.try_emplace(key, static_cast<uint32_t>(edges.size()));
                if (made) edges.push_back(key);
                ring[k] = at->second;
            }
            // The neighbour could have the same diagonal between two crossings of an ambiguous face.
            if (loops.ambiguous[l] && length > 3) {
                const auto middle = kMiddle | static_cast<uint32_t>(rings.size());
                rings.emplace_back(ring.begin(), ring.begin() + length);
                for (unsigned k = 0; k < length; ++k) mesh.indices.insert(mesh.indices.end(), {ring[k], ring[(k + 1) % length], middle});
            } else {
                for (unsigned k = 1; k + 1 < length; ++k) mesh.indices.insert(mesh.indices.end(), {ring[0], ring[k], ring[k + 1]});
            }
        }
    }
    const size_t onEdges = edges.size();
    for (uint32_t& i : mesh.indices)
        if ((i & kMiddle) != 0) i = static_cast<uint32_t>(onEdges) + (i & ~kMiddle);

    mesh.positions.resize(onEdges + rings.size());
    mesh.normals.resize(mesh.positions.size());
    std::vector<dvec3> at(mesh.positions.size());
    parallelFor(size_t{0}, onEdges, [&](size_t i) { at[i] = crossingOf(surface, edges[i], step); });
    for (size_t i = 0; i < rings.size(); ++i) {
        for (const uint32_t k : rings[i]) at[onEdges + i] += at[k];
        at[onEdges + i] /= static_cast<double>(rings[i].size());
    }
    parallelFor(size_t{0}, at.size(), [&](size_t i) {
        mesh.positions[i] = vec3(at[i]);
        mesh.normals[i] = vec3(surface.normal(at[i]));
    });
    return mesh;
}

}  // namespace rivulet
