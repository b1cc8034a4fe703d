#include "assets/make_head/surface.h"

#include <algorithm>
#include <map>
#include <unordered_map>

namespace rivulet::head {
namespace {

uint64_t directed(uint32_t a, uint32_t b) { return uint64_t{a} << 32 | b; }
uint64_t undirected(uint32_t a, uint32_t b) { return directed(std::min(a, b), std::max(a, b)); }

// The next boundary vertex of each boundary vertex, in the orientation of the triangles.
std::map<uint32_t, uint32_t> boundarySteps(const Surface& surface) {
    std::unordered_map<uint64_t, int> edges;
    for (const Triangle& t : surface.triangles)
        for (int k = 0; k < 3; ++k) edges[directed(t[k], t[(k + 1) % 3])] = 1;
    std::map<uint32_t, uint32_t> steps;
    for (const Triangle& t : surface.triangles)
        for (int k = 0; k < 3; ++k)
            if (uint32_t a = t[k], b = t[(k + 1) % 3]; !edges.contains(directed(b, a))) steps[a] = b;
    return steps;
}

}  // namespace

void Vertex::add(const Vertex& other, double factor) {
    at += other.at * factor;
    uv += other.uv * factor;
    for (int w = 0; w < kWeights; ++w) weight[w] += other.weight[w] * factor;
}

uint32_t Surface::add(const Vertex& vertex) {
    vertices.push_back(vertex);
    return static_cast<uint32_t>(vertices.size() - 1);
}

double uvArea(const Surface& surface, const Triangle& t) {
    dvec2 a = surface.vertices[t[0]].uv, ab = surface.vertices[t[1]].uv - a, ac = surface.vertices[t[2]].uv - a;
    return 0.5 * (ab.x * ac.y - ab.y * ac.x);
}

void Surface::addTriangle(uint32_t a, uint32_t b, uint32_t c) {
    Triangle t = {a, b, c};
    if (uvArea(*this, t) < 0) std::swap(t[1], t[2]);
    triangles.push_back(t);
}

void Surface::addStrip(const std::vector<uint32_t>& from, const std::vector<uint32_t>& to, bool closed) {
    size_t n = from.size();
    for (size_t i = 0; i + (closed ? 0 : 1) < n; ++i) {
        uint32_t a = from[i], b = from[(i + 1) % n], c = to[(i + 1) % n], d = to[i];
        bool mirrored = vertices[a].at.x + vertices[b].at.x < 0;
        addTriangle(a, b, mirrored ? d : c);
        addTriangle(mirrored ? b : a, c, d);
    }
}

void Surface::dropUnusedVertices() {
    std::vector<uint32_t> name(vertices.size(), UINT32_MAX);
    for (const Triangle& t : triangles)
        for (uint32_t v : t) name[v] = 0;
    std::vector<Vertex> kept;
    for (size_t v = 0; v < vertices.size(); ++v)
        if (name[v] == 0) {
            name[v] = static_cast<uint32_t>(kept.size());
            kept.push_back(vertices[v]);
        }
    for (Triangle& t : triangles)
        for (uint32_t& v : t) v = name[v];
    vertices = std::move(kept);
}

Neighbours neighboursOf(const Surface& surface) {
    Neighbours all(surface.vertices.size());
    for (const Triangle& t : surface.triangles)
        for (int k = 0; k < 3; ++k) {
            all[t[k]].push_back(t[(k + 1) % 3]);
            all[t[k]].push_back(t[(k + 2) % 3]);
        }
    for (auto& ring : all) {
        std::sort(ring.begin(), ring.end());
        ring.erase(std::unique(ring.begin(), ring.end()), ring.end());
    }
    return all;
}

std::vector<std::vector<uint32_t>> boundaryLoops(const Surface& surface) {
    std::map<uint32_t, uint32_t> steps = boundarySteps(surface);
    std::vector<std::vector<uint32_t>> loops;
    while (!steps.empty()) {
        std::vector<uint32_t>& loop = loops.emplace_back();
        for (auto at = steps.begin(); at != steps.end(); at = steps.find(loop.back())) {
            loop.push_back(at->second);
            steps.erase(at);
        }
    }
    return loops;
}

std::vector<dvec3> normalsOf(const std::vector<dvec3>& positions, const std::vector<Triangle>& triangles) {
    std::vector<dvec3> normals(positions.size(), dvec3(0));
    for (const Triangle& t : triangles) {
        dvec3 area = glm::cross(positions[t[1]] - positions[t[0]], positions[t[2]] - positions[t[0]]);
        for (uint32_t v : t) normals[v] += area;
    }
    for (dvec3& n : normals) n = glm::dot(n, n) > 0 ? glm::normalize(n) : dvec3(0, 1, 0);
    return normals;
}

std::vector<dvec3> positionsOf(const Surface& surface) {
    std::vector<dvec3> positions;
    positions.reserve(surface.vertices.size());
    for (const Vertex& v : surface.vertices) positions.push_back(v.at);
    return positions;
}

Surface subdivided(const Surface& surface) {
    struct Edge {
        uint32_t middle = 0;
        std::array<uint32_t, 2> opposite{};
        int sides = 0;
    };
    std::unordered_map<uint64_t, Edge> edges;
    for (const Triangle& t : surface.triangles)
        for (int k = 0; k < 3; ++k) {
            Edge& e = edges[undirected(t[k], t[(k + 1) % 3])];
            if (e.sides < 2) e.opposite[e.sides++] = t[(k + 2) % 3];
        }
    Surface fine;
    Neighbours around = neighboursOf(surface);
    for (uint32_t v = 0; v < surface.vertices.size(); ++v) {
        Vertex moved;
        std::vector<uint32_t> rim;
        for (uint32_t n : around[v])
            if (edges[undirected(v, n)].sides == 1) rim.push_back(n);
        if (rim.size() == 2) {
            moved.add(surface.vertices[v], 0.75);
            for (uint32_t n : rim) moved.add(surface.vertices[n], 0.125);
        } else {
            auto n = static_cast<double>(around[v].size());
            double beta = n == 3 ? 3.0 / 16 : 3 / (8 * n);  // Warren's weights
            moved.add(surface.vertices[v], 1 - n * beta);
            for (uint32_t other : around[v]) moved.add(surface.vertices[other], beta);
        }
        fine.add(moved);
    }
    for (const Triangle& t : surface.triangles) {
        Triangle middle;
        for (int k = 0; k < 3; ++k) {
            uint32_t a = t[k], b = t[(k + 1) % 3];
            Edge& e = edges[undirected(a, b)];
            if (e.middle == 0) {
                Vertex between;
                double ends = e.sides == 2 ? 0.375 : 0.5;
                between.add(surface.vertices[a], ends);
                between.add(surface.vertices[b], ends);
                for (int s = 0; e.sides == 2 && s < 2; ++s) between.add(surface.vertices[e.opposite[s]], 0.125);
                e.middle = fine.add(between);
            }
            middle[k] = e.middle;
        }
        for (int k = 0; k < 3; ++k) fine.triangles.push_back({t[k], middle[k], middle[(k + 2) % 3]});
        fine.triangles.push_back(middle);
    }
    return fine;
}

}  // namespace rivulet::head
