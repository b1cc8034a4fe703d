#include "fluid/sim/solids/body_shapes.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <memory>
#include <random>
#include <unordered_map>

#include "engine/core/jobs.h"

namespace rivulet {

namespace {

constexpr float kApart = 0.8F;        // spacings: no two darts are nearer
constexpr double kDartsEach = 40;     // darts thrown per square spacing
constexpr double kMostDarts = 4.0e7;  // beyond this a mesh has more samples than any fluid has particles

struct Triangle {
    dvec3 a, b, c;
};
Triangle triangleOf(const MeshView& mesh, size_t t) {
    return {dvec3(mesh.positions[mesh.indices[3 * t]]), dvec3(mesh.positions[mesh.indices[3 * t + 1]]),
            dvec3(mesh.positions[mesh.indices[3 * t + 2]])};
}

// Volume, centre of mass, second moments about it, of what a closed mesh holds: sums over tetrahedra to the origin.
struct Solid {
    double volume = 0;
    dvec3 centre{0.0};
    dmat3 moments{0.0};  // integral of x x^T dV
};
Solid solidOf(const MeshView& mesh) {
    Solid s;
    // About a point of the mesh, so that one far from its origin loses no digits.
    const dvec3 about = mesh.positions.empty() ? dvec3(0.0) : dvec3(mesh.positions[0]);
    for (size_t t = 0; t < mesh.triangleCount(); ++t) {
        Triangle f = triangleOf(mesh, t);
        f = {f.a - about, f.b - about, f.c - about};
        const double v = glm::dot(f.a, glm::cross(f.b, f.c)) / 6;
        const dvec3 sum = f.a + f.b + f.c;
        s.volume += v;
        s.centre += sum * (v / 4);
        s.moments +=
            (glm::outerProduct(f.a, f.a) + glm::outerProduct(f.b, f.b) + glm::outerProduct(f.c, f.c) + glm::outerProduct(sum, sum)) *
            (v / 20);
    }
    if (s.volume > 0) s.centre /= s.volume;
    s.moments -= glm::outerProduct(s.centre, s.centre) * s.volume;
    s.centre += about;
    return s;
}

// Turns a symmetric matrix onto its diagonal (Jacobi): its columns are the axes.
dmat3 principalAxes(dmat3 m) {
    dmat3 axes(1.0);
    for (int sweep = 0; sweep < 50; ++sweep)
        for (int p = 0; p < 2; ++p)
            for (int q = p + 1; q < 3; ++q) {
                if (std::abs(m[p][q]) <= 1e-14 * (std::abs(m[p][p]) + std::abs(m[q][q]))) continue;
                const double theta = 0.5 * std::atan2(2 * m[p][q], m[q][q] - m[p][p]);
                dmat3 r(1.0);
                r[p][p] = r[q][q] = std::cos(theta);
                r[q][p] = std::sin(theta);
                r[p][q] = -std::sin(theta);
                m = glm::transpose(r) * m * r;
                axes = axes * r;
            }
    if (glm::determinant(axes) < 0) axes[2] = -axes[2];
    return axes;
}

double distanceTo(const dvec3& p, const Triangle& t) {
    const dvec3 n = glm::cross(t.b - t.a, t.c - t.a);
    const auto beside = [&](const dvec3& u, const dvec3& v) { return glm::dot(glm::cross(v - u, p - u), n) >= 0; };
    if (glm::dot(n, n) > 0 && beside(t.a, t.b) && beside(t.b, t.c) && beside(t.c, t.a))
        return std::abs(glm::dot(p - t.a, n)) / glm::length(n);
    const auto edge = [&](const dvec3& u, const dvec3& v) {
        const double square = glm::dot(v - u, v - u);
        const double along = square > 0 ? std::clamp(glm::dot(p - u, v - u) / square, 0.0, 1.0) : 0.0;
        return glm::length(p - u - (v - u) * along);
    };
    return std::min({edge(t.a, t.b), edge(t.b, t.c), edge(t.c, t.a)});
}

// Solid angle of a triangle over 4 pi (van Oosterom and Strackee 1983).
double winding(const dvec3& p, const Triangle& t) {
    const dvec3 a = t.a - p, b = t.b - p, c = t.c - p;
    const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
    const double down = la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb;
    return std::atan2(glm::dot(a, glm::cross(b, c)), down) / (2 * kPiD);
}

double nearest(const std::vector<Triangle>& triangles, const dvec3& p) {
    double least = 1e30;
    for (const Triangle& t : triangles) least = std::min(least, distanceTo(p, t));
    return least;
}

// Points of each triangle, about `apart` from each other, in rows along its longest side; farther apart if there were more than
// kMostPoints.
std::vector<ShellPoint> shellOf(const std::vector<Triangle>& triangles, float apart) {
    constexpr double kMostPoints = 4.0e6;
    double area = 0;
    for (const Triangle& t : triangles) area += 0.5 * glm::length(glm::cross(t.b - t.a, t.c - t.a));
    const double step = std::max(double{apart}, std::sqrt(area / kMostPoints));
    std::vector<ShellPoint> points;
    for (const Triangle& t : triangles) {
        const dvec3 across = glm::cross(t.b - t.a, t.c - t.a);
        if (!(glm::dot(across, across) > 0)) continue;
        const vec3 normal(glm::normalize(across));
        dvec3 a = t.a, b = t.b, top = t.c;
        for (int k = 0; k < 2; ++k)
            if (glm::length(top - b) > glm::length(b - a) || glm::length(a - top) > glm::length(b - a)) {
                const dvec3 first = a;
                a = b, b = top, top = first;
            }
        const double longest = glm::length(b - a);
        const auto rows = static_cast<int>(std::ceil(std::min(glm::length(across) / (longest * step), kMostPoints)));
        for (int j = 0; j < rows; ++j) {
            const double up = (j + 0.5) / rows;
            const auto count = static_cast<int>(std::ceil(std::min(longest * (1 - up) / step, kMostPoints)));
            for (int i = 0; i < count; ++i) points.push_back({vec3(a + (b - a) * ((1 - up) * (i + 0.5) / count) + (top - a) * up), normal});
        }
    }
    return points;
}

// Points on a ball along a spiral, each for the same area.
std::vector<dvec3> spiral(int count) {
    std::vector<dvec3> points;
    const double turn = kPiD * (3 - std::sqrt(5.0));
    for (int k = 0; k < count; ++k) {
        const double y = 1 - (2 * k + 1.0) / count, across = std::sqrt(1 - y * y);
        points.emplace_back(across * std::cos(turn * k), y, across * std::sin(turn * k));
    }
    return points;
}

// Distance from a point of triangle `own` to the mesh in a direction (Moeller and Trumbore 1997).
double thickness(const std::vector<Triangle>& triangles, size_t own, const dvec3& from, const dvec3& along) {
    double least = 1e30;
    for (size_t k = 0; k < triangles.size(); ++k) {
        if (k == own) continue;
        const Triangle& t = triangles[k];
        const dvec3 ab = t.b - t.a, ac = t.c - t.a, h = glm::cross(along, ac);
        const double det = glm::dot(ab, h);
        if (det == 0) continue;
        const dvec3 s = from - t.a, q = glm::cross(s, ab);
        const double u = glm::dot(s, h) / det, v = glm::dot(along, q) / det, way = glm::dot(ac, q) / det;
        if (u >= 0 && v >= 0 && u + v <= 1 && way > 0) least = std::min(least, way);
    }
    return least;
}

// Random points on the surface, moved inwards by half a spacing, or to the middle of thin parts.
std::vector<vec3> meshSamples(const std::vector<Triangle>& triangles, float spacing) {
    std::vector<double> area;
    area.reserve(triangles.size());
    double total = 0;
    for (const Triangle& f : triangles) area.push_back(total += 0.5 * glm::length(glm::cross(f.b - f.a, f.c - f.a)));
    std::vector<vec3> kept;
    std::mt19937 random(1);
    const auto unit = [&] { return static_cast<double>(random()) / 4294967296.0; };
    const double apart = kApart * double{spacing}, deep = 0.5 * double{spacing};
    const auto cellOf = [&](const dvec3& p, const ivec3& off) {
        const glm::i64vec3 c = glm::i64vec3(glm::floor(p / apart)) + glm::i64vec3(off);
        return (c.x * 73856093) ^ (c.y * 19349663) ^ (c.z * 83492791);
    };
    std::unordered_map<int64_t, std::vector<uint32_t>> cells;
    const auto crowded = [&](const dvec3& p) {
        for (int z = -1; z <= 1; ++z)
            for (int y = -1; y <= 1; ++y)
                for (int x = -1; x <= 1; ++x)
                    if (const auto found = cells.find(cellOf(p, {x, y, z})); found != cells.end())
                        for (const uint32_t other : found->second)
                            if (glm::length(dvec3(kept[other]) - p) < apart) return true;
        return false;
    };
    const std::atomic<bool>* const stop = currentJobs().stop;
    const double darts = std::min(std::ceil(kDartsEach * total / (double{spacing} * spacing)) + 100, kMostDarts);
    for (double k = 0; k < darts; ++k) {
        const auto t = static_cast<size_t>(std::upper_bound(area.begin(), area.end() - 1, unit() * total) - area.begin());
        double u = unit(), v = unit();
        if (u + v > 1) {
            u = 1 - u;
            v = 1 - v;
        }
        const Triangle& f = triangles[t];
        const dvec3 on = f.a + (f.b - f.a) * u + (f.c - f.a) * v, across = glm::cross(f.b - f.a, f.c - f.a);
        if (!(glm::dot(across, across) > 0)) continue;
        const dvec3 in = -glm::normalize(across);
        if (crowded(on + in * deep)) continue;
        if (stop != nullptr && *stop) throw LoopStopped();
        const double thick = thickness(triangles, t, on, in);
        const dvec3 p = on + in * std::min(deep, 0.5 * thick);
        // Beside a sharp edge it would lie under one face and almost on the other.
        if (thick > 2 * deep && nearest(triangles, p) < 0.7 * deep) continue;
        if (thick < 2 * deep && crowded(p)) continue;
        cells[cellOf(p, ivec3(0))].push_back(static_cast<uint32_t>(kept.size()));
        kept.emplace_back(p);
    }
    return kept;
}

}  // namespace

BodyShape boxShape(const vec3& size, double density, float spacing) {
    BodyShape s;
    const dvec3 d(size);
    const vec3 inner = glm::max(size - spacing, vec3(0.0F));
    ivec3 n;
    for (int k = 0; k < 3; ++k) n[k] = static_cast<int>(std::lround(inner[k] / spacing));
    const auto at = [&](int k, int axis) {  // a side thinner than a spacing has one layer, in its middle
        return n[axis] == 0 ? 0.0F : (static_cast<float>(k) / static_cast<float>(n[axis]) - 0.5F) * inner[axis];
    };
    for (int z = 0; z <= n.z; ++z)
        for (int y = 0; y <= n.y; ++y)
            for (int x = 0; x <= n.x; ++x)
                if (x == 0 || y == 0 || z == 0 || x == n.x || y == n.y || z == n.z) s.samples.emplace_back(at(x, 0), at(y, 1), at(z, 2));
    s.volume = size.x * size.y * size.z;
    s.mass = static_cast<float>(density * s.volume);
    const dvec3 squares = d * d;
    s.inertia = vec3(density * d.x * d.y * d.z / 12 * dvec3(squares.y + squares.z, squares.x + squares.z, squares.x + squares.y));
    s.distance = [half = 0.5F * size](const vec3& p) {
        const vec3 q = glm::abs(p) - half;
        return glm::length(glm::max(q, vec3(0.0F))) + std::min(std::max({q.x, q.y, q.z}), 0.0F);
    };
    s.shell = [half = 0.5 * d](float apart) {
        std::vector<Triangle> faces;
        for (int axis = 0; axis < 3; ++axis)
            for (const double side : {-1.0, 1.0}) {
                dvec3 n(0.0), u(0.0);
                n[axis] = side;
                u[(axis + 1) % 3] = 1;
                const dvec3 v = glm::cross(n, u);
                faces.push_back({(n - u - v) * half, (n + u - v) * half, (n + u + v) * half});
                faces.push_back({(n - u - v) * half, (n + u + v) * half, (n - u + v) * half});
            }
        return shellOf(faces, apart);
    };
    return s;
}

BodyShape sphereShape(float radius, double density, float spacing) {
    BodyShape s;
    const double r = radius, inner = std::max(r - 0.5 * spacing, 0.0);
    const int n = inner > 0 ? std::max(static_cast<int>(std::lround(4 * kPiD * inner * inner / (double{spacing} * spacing))), 4) : 1;
    for (const dvec3& p : spiral(n)) s.samples.emplace_back(p * inner);
    const double volume = 4.0 / 3.0 * kPiD * r * r * r;
    s.volume = static_cast<float>(volume);
    s.mass = static_cast<float>(density * volume);
    s.inertia = vec3(static_cast<float>(0.4 * density * volume * r * r));
    s.distance = [radius](const vec3& p) { return glm::length(p) - radius; };
    s.shell = [r](float apart) {
        std::vector<ShellPoint> points;
        for (const dvec3& p : spiral(std::max(static_cast<int>(4 * kPiD * r * r / (0.5 * double{apart} * double{apart})), 16)))
            points.push_back({vec3(p * r), vec3(p)});
        return points;
    };
    return s;
}

std::vector<ShellPoint> meshShell(const MeshView& mesh, float apart) {
    std::vector<Triangle> triangles;
    for (size_t t = 0; t < mesh.triangleCount(); ++t) triangles.push_back(triangleOf(mesh, t));
    return shellOf(triangles, apart);
}

Result<MeshBody> meshShape(const MeshView& mesh, double density, float spacing) {
    if (mesh.triangleCount() == 0) return badInput("the mesh has no triangles");
    const Solid solid = solidOf(mesh);
    Bounds bounds;
    for (const vec3& p : mesh.positions) bounds.add(p);
    const dvec3 size(bounds.size());
    const double longest = std::max({size.x, size.y, size.z});
    if (!(solid.volume > 1e-9 * longest * longest * longest))
        return badInput("the mesh holds no volume: a body's mesh must be closed, its triangles counter-clockwise from outside");
    const dmat3 axes = principalAxes(solid.moments);
    MeshBody body;
    body.frame.position = vec3(solid.centre);
    body.frame.rotation = glm::normalize(quat(glm::quat_cast(axes)));
    BodyShape& s = body.shape;
    s.volume = static_cast<float>(solid.volume);
    s.mass = static_cast<float>(density * solid.volume);
    const dmat3 own = glm::transpose(axes) * solid.moments * axes;
    s.inertia = vec3(density * dvec3(own[1][1] + own[2][2], own[0][0] + own[2][2], own[0][0] + own[1][1]));
    auto triangles = std::make_shared<std::vector<Triangle>>();
    for (size_t t = 0; t < mesh.triangleCount(); ++t) {
        const Triangle f = triangleOf(mesh, t);
        const auto own3 = [&](const dvec3& p) { return dvec3(body.frame.toOwn(vec3(p))); };
        triangles->push_back({own3(f.a), own3(f.b), own3(f.c)});
    }
    s.samples = meshSamples(*triangles, spacing);
    s.distance = [triangles](const vec3& p) {
        double turns = 0;
        for (const Triangle& t : *triangles) turns += winding(dvec3(p), t);
        const double far = nearest(*triangles, dvec3(p));
        return static_cast<float>(turns > 0.5 ? -far : far);
    };
    s.shell = [triangles](float apart) { return shellOf(*triangles, apart); };
    return body;
}

}  // namespace rivulet
