#include "assets/make_head/hair.h"

#include <algorithm>
#include <cmath>

#include "assets/make_head/noise.h"

namespace rivulet::head {
namespace {

constexpr uint32_t kNumbers = 200;  // of ribbons, in turn

// A ribbon along `line`; its face looks along `out`.
void addRibbon(Part& part, const std::vector<dvec3>& line, dvec3 out, double width, uint32_t number) {
    const auto first = static_cast<uint32_t>(part.positions.size());
    const auto joints = static_cast<uint32_t>(line.size());
    for (uint32_t s = 0; s < joints; ++s) {
        const dvec3 along = line[std::min(s + 1, joints - 1)] - line[s > 0 ? s - 1 : 0];
        const dvec3 across = glm::normalize(glm::cross(along, out)), face = glm::normalize(glm::cross(across, along));
        for (const double sign : {-1.0, 1.0}) {
            part.positions.push_back(line[s] + across * (sign * 0.5 * width));
            part.uvs.emplace_back(number % kNumbers + 0.5 + 0.499 * sign, static_cast<double>(s) / (joints - 1));
            part.normals.push_back(face);
        }
    }
    for (uint32_t s = 0; s + 1 < joints; ++s) {
        const uint32_t a = first + 2 * s;
        part.triangles.push_back({a, a + 1, a + 2});
        part.triangles.push_back({a + 1, a + 3, a + 2});
    }
}

struct Root {
    dvec3 at, normal;
    double crop = 0;
};

// About `perArea` roots a cm^2 of full crop; towards its edge hairs are finer, and their number falls slower than the crop.
std::vector<Root> scalpRoots(const Surface& head, const std::vector<dvec3>& normals, double perArea) {
    std::vector<Root> roots;
    double due = 0;
    for (size_t k = 0; k < head.triangles.size(); ++k) {
        const Triangle& t = head.triangles[k];
        const Vertex *a = &head.vertices[t[0]], *b = &head.vertices[t[1]], *c = &head.vertices[t[2]];
        const double ear = (a->weight[kEar] + b->weight[kEar] + c->weight[kEar]) / 3;
        const dvec3 middle = (a->at + b->at + c->at) / 3.0;
        // Behind the ears a sparser crop covers as well: its hairs lie flat.
        const double crop = cropAt(middle, ear) * glm::mix(0.7, 1.0, smoothstep(-9.0, -6.0, middle.z)),
                     area = 0.5 * glm::length(glm::cross(b->at - a->at, c->at - a->at));
        for (due += area * perArea * crop * smoothstep(0.02, 0.22, crop) * (2.0 - crop); due >= 1; due -= 1) {
            const auto n = static_cast<int64_t>(roots.size());
            double u = hash(n, 0, 0, 201), v = hash(n, 1, 0, 201);
            if (u + v > 1) u = 1 - u, v = 1 - v;
            const dvec3 normal = normals[t[0]] * (1 - u - v) + normals[t[1]] * u + normals[t[2]] * v;
            roots.push_back({a->at * (1 - u - v) + b->at * u + c->at * v, glm::normalize(normal), crop});
        }
    }
    return roots;
}

}  // namespace

double cropAt(dvec3 p, double ear) {
    const double x = std::abs(p.x);
    const double front = 8.35 + 0.75 * smoothstep(0.8, 3.6, x) - 1.2 * smoothstep(4.2, 6.2, x);
    const double side = glm::mix(1.2, -3.8, smoothstep(-4.5, -9.5, p.z)), edge = glm::mix(front, side, smoothstep(2.6, -2.4, p.z));
    return smoothstep(-0.7, 1.5, p.y - edge + 0.5 * fractal(p * 1.1, 2, 91) + 0.8 * fractal(p * dvec3(8, 2.2, 8), 2, 92)) * (1 - ear);
}

double browHalfWidth(double t) { return 0.36 * (0.62 + 0.38 * smoothstep(0.0, 0.3, t)) * (1 - 0.82 * smoothstep(0.4, 1.05, t)); }

Part makeHair(const Surface& head) {
    Part part;
    part.name = "hair";
    part.material = "hair";
    const std::vector<dvec3> normals = normalsOf(positionsOf(head), head.triangles);
    const dvec3 crown(0.8, 13.0, -9.5);
    std::vector<Root> roots = scalpRoots(head, normals, 10.2);
    // From the edges to the crown: what grows nearer to the crown lies over the rest.
    std::stable_sort(roots.begin(), roots.end(),
                     [&](const Root& a, const Root& b) { return glm::distance(a.at, crown) > glm::distance(b.at, crown); });
    uint32_t number = 0;
    for (const Root& root : roots) {
        const auto n = static_cast<int64_t>(++number);
        const dvec3 p = root.at;
        // Combed away from the crown, forward on top and down at the sides, in locks.
        dvec3 way = p - crown;
        way += dvec3(0.3, 0, 1.0) * (4.0 * smoothstep(8.5, 12.0, p.y));
        way = glm::normalize(way) + 0.55 * dvec3(noise(p * 0.55, 211), noise(p * 0.55, 212), noise(p * 0.55, 213)) +
              glm::mix(1.3, 0.55, root.crop) * dvec3(hash(n, 0, 0, 214) - 0.5, hash(n, 1, 0, 214) - 0.5, hash(n, 2, 0, 214) - 0.5);
        way = glm::normalize(way - root.normal * glm::dot(way, root.normal));
        const double top = smoothstep(6.0, 10.5, p.y), edge = smoothstep(0.12, 0.85, root.crop);
        const double length = glm::mix(0.75, 2.3, top) * glm::mix(0.45, 1.0, edge) * (0.5 + 0.9 * hash(n, 3, 0, 214));
        const double rise = glm::mix(0.35, 0.75, top) * glm::mix(0.5, 1.0, edge) * (0.8 + 0.4 * hash(n, 4, 0, 214));
        std::vector<dvec3> line;
        const int joints = top > 0.5 ? 4 : 3;  // short hairs bend little
        for (int s = 0; s < joints; ++s) {
            const double u = static_cast<double>(s) / (joints - 1);
            // It leaves the skin and bends down to lie along it.
            line.push_back(p - root.normal * 0.03 + length * (way * (u * (0.55 + 0.45 * u)) + root.normal * (rise * (u - 0.62 * u * u))) +
                           dvec3(0, -0.10 * length * u * u, 0));
        }
        addRibbon(part, line, root.normal, glm::mix(0.11, 0.19, top) * glm::mix(0.16, 1.0, edge), number);
    }
    return part;
}

Part makeBrows(const Surface& head, std::vector<uint32_t>& roots) {
    Part part;
    part.name = "brows";
    part.material = "hair";
    const std::vector<dvec3> normals = normalsOf(positionsOf(head), head.triangles);
    constexpr int kHairs = 290;
    uint32_t number = 0;
    for (const double side : {1.0, -1.0})
        for (int h = 0; h < kHairs; ++h) {
            const double t = (h + hash(h, 0, 0, 71)) / kHairs, begin = 1 - smoothstep(0.0, 0.26, t);
            // By the nose it begins with single fine hairs.
            if (hash(h, 5, 0, 71) < 0.62 * begin) continue;
            const double across = (2 * hash(h, 1, 0, 71) - 1) * (1 + 0.25 * begin * hash(h, 6, 0, 71));
            const double place = t * (kBrowLine.size() - 1);
            const auto i = std::min(static_cast<size_t>(place), kBrowLine.size() - 2);
            const dvec3 outward = glm::normalize(kBrowLine[i + 1] - kBrowLine[i]) * dvec3(side, 1, 1);
            dvec3 on = glm::mix(kBrowLine[i], kBrowLine[i + 1], place - static_cast<double>(i)) * dvec3(side, 1, 1);
            on.y += across * browHalfWidth(t) * 0.9;
            uint32_t root = 0;
            double nearest = 1e9;
            for (uint32_t v = 0; v < head.vertices.size(); ++v)
                if (const double d = glm::distance(head.vertices[v].at, on); d < nearest) {
                    nearest = d;
                    root = v;
                }
            const dvec3 normal = normals[root], from = on + normal * glm::dot(head.vertices[root].at - on, normal);
            // Upright near the nose, then outward; upper hairs bend down, lower ones up.
            double angle =
                glm::mix(1.35, 0.25, smoothstep(0.0, 0.35, t)) - 0.55 * across * smoothstep(0.15, 0.6, t) - 0.25 * smoothstep(0.6, 1.0, t);
            angle += 0.35 * (hash(h, 2, 0, 71) - 0.5);
            const dvec3 flat = glm::normalize(outward - normal * glm::dot(outward, normal)), up = glm::cross(normal, flat) * side;
            const double length = glm::mix(0.55, 0.8, hash(h, 3, 0, 71)) * (0.6 + 0.4 * std::sin(kPi * std::min(t + 0.2, 1.0))) *
                                  glm::mix(1.0, 0.62 + 0.3 * hash(h, 7, 0, 71), begin);
            std::vector<dvec3> line;
            constexpr int kJoints = 4;
            for (int s = 0; s < kJoints; ++s) {
                const double u = static_cast<double>(s) / (kJoints - 1), bent = angle - 0.4 * u;
                line.push_back(from + length * (u - 0.3) * (flat * std::cos(bent) + up * std::sin(bent)) +
                               normal * (0.012 + 0.11 * length * (4 * u * (1 - u)) + 0.02 * u));
            }
            addRibbon(part, line, normal, 0.052 * glm::mix(1.0, 0.55, begin), ++number);
            roots.resize(part.positions.size(), root);
        }
    return part;
}

}  // namespace rivulet::head
