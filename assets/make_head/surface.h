// The surface of the head: triangles with one UV chart and named weights, and Loop subdivision of all attributes. Lengths in cm, +Y up, +Z
// forward.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <numbers>
#include <vector>

namespace rivulet::head {

inline constexpr double kPi = std::numbers::pi;

using glm::dvec2;
using glm::dvec3;
using Triangle = std::array<uint32_t, 3>;

// Weights that are set for named parts; subdivision interpolates them.
enum Weight { kJaw, kLip, kMouth, kEar, kLoft, kRim, kNostril, kWeights };

struct Vertex {
    dvec3 at{0};
    dvec2 uv{0};
    std::array<double, kWeights> weight{};
    void add(const Vertex& other, double factor);
};

struct Surface {
    std::vector<Vertex> vertices;
    std::vector<Triangle> triangles;
    uint32_t add(const Vertex& vertex);
    // Turned so that its UVs run counter-clockwise, which is outward everywhere on the chart.
    void addTriangle(uint32_t a, uint32_t b, uint32_t c);
    // Between two runs of equal length; the diagonal is mirrored at x = 0, so that the mesh stays symmetric.
    void addStrip(const std::vector<uint32_t>& from, const std::vector<uint32_t>& to, bool closed);
    void dropUnusedVertices();
};

using Neighbours = std::vector<std::vector<uint32_t>>;

double uvArea(const Surface& surface, const Triangle& t);
Neighbours neighboursOf(const Surface& surface);
std::vector<std::vector<uint32_t>> boundaryLoops(const Surface& surface);
std::vector<dvec3> normalsOf(const std::vector<dvec3>& positions, const std::vector<Triangle>& triangles);
std::vector<dvec3> positionsOf(const Surface& surface);
Surface subdivided(const Surface& surface);

// A Gaussian of height 1.
inline double bell(dvec3 p, dvec3 centre, dvec3 width) {
    dvec3 d = (p - centre) / width;
    return std::exp(-0.5 * glm::dot(d, d));
}

inline double smoothstep(double from, double to, double x) {
    double t = glm::clamp((x - from) / (to - from), 0.0, 1.0);
    return t * t * (3 - 2 * t);
}

}  // namespace rivulet::head
