#include "assets/make_head/cage.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

#include "engine/core/file.h"

namespace rivulet::head {
namespace {

constexpr int kMeridians = 36;  // one from each vertex of the face's boundary to the neck's edge
constexpr int kRings = 15;
constexpr int kChin = 152;

using Ids = std::vector<uint32_t>;

const Ids kLidLoops[2] = {{263, 249, 390, 373, 374, 380, 381, 382, 362, 398, 384, 385, 386, 387, 388, 466},
                          {33, 7, 163, 144, 145, 153, 154, 155, 133, 173, 157, 158, 159, 160, 161, 246}};
// The lips from the outer line to the inner: right corner, upper lip, left corner, lower lip.
const Ids kLipLoops[4] = {{61, 185, 40, 39, 37, 0, 267, 269, 270, 409, 291, 375, 321, 405, 314, 17, 84, 181, 91, 146},
                          {76, 184, 74, 73, 72, 11, 302, 303, 304, 408, 306, 307, 320, 404, 315, 16, 85, 180, 90, 77},
                          {62, 183, 42, 41, 38, 12, 268, 271, 272, 407, 292, 325, 319, 403, 316, 15, 86, 179, 89, 96},
                          {78, 191, 80, 81, 82, 13, 312, 311, 310, 415, 308, 324, 318, 402, 317, 14, 87, 178, 88, 95}};

void dropInside(Surface& face, const Ids& loop) {
    std::set<uint32_t> on(loop.begin(), loop.end());
    std::erase_if(face.triangles, [&](const Triangle& t) { return on.contains(t[0]) && on.contains(t[1]) && on.contains(t[2]); });
}

// The chart of the face: symmetric, and shrunk into the middle of the tile, where cranium and neck go around it.
void layFaceInTile(Surface& face) {
    auto count = static_cast<uint32_t>(face.vertices.size());
    std::vector<dvec2> uv(count);
    for (uint32_t v = 0; v < count; ++v) {
        dvec3 p = face.vertices[v].at * dvec3(-1, 1, 1);
        uint32_t twin = 0;
        for (uint32_t other = 1; other < count; ++other)
            if (glm::distance(face.vertices[other].at, p) < glm::distance(face.vertices[twin].at, p)) twin = other;
        dvec2 a = face.vertices[v].uv, b = face.vertices[twin].uv;
        uv[v] = {0.5 + 0.5 * (a.x - b.x), 0.5 * (a.y + b.y)};
    }
    for (uint32_t v = 0; v < count; ++v) face.vertices[v].uv = {0.5 + (uv[v].x - 0.5) * 0.735, 0.5 + (uv[v].y - 0.47) * 0.77};
}

// The model's forehead is inclined more than that of a skull.
void fillForehead(Surface& face) {
    for (Vertex& v : face.vertices) v.at.z += 0.55 * smoothstep(5.2, 8.4, v.at.y);
}

// The model's lips are half a centimetre apart, and their chart has no room for the surface between them.
void closeLips(Surface& face) {
    const double share[4] = {0.08, 0.4, 0.85, 1.0};
    for (int row = 0; row < 4; ++row)
        for (size_t i = 0; i < kLipLoops[row].size(); ++i) {
            Vertex& v = face.vertices[kLipLoops[row][i]];
            v.weight[kLip] = row == 0 ? 0.5 : 1;
            if (i == 0 || i == 10) continue;
            bool upper = i < 10;
            double across = std::sin(kPi * static_cast<double>(i % 10) / 10);
            v.at.y += (upper ? -0.22 : 0.33) * share[row] * std::pow(across, 0.6);
            if (!upper) v.at.z += 0.12 * across * std::min(1.0, row + 0.5);
            if (row == 3) v.at.z += upper ? 0.06 * across : -0.10 * across;
            if (row >= 2) v.uv.y += (upper ? 1 : -1) * (row == 3 ? 0.005 : 0.002) * std::sqrt(across);
        }
}

// The inside of the lips, and a closed bag behind them.
void addMouth(Surface& face) {
    const double depth[3] = {0.4, 1.1, 2.4}, rise[3] = {0.03, 0.45, 0.7}, narrow[3] = {0.97, 0.92, 0.8}, chart[3] = {0.75, 0.5, 0.25};
    Ids ring = kLipLoops[3];
    const dvec2 middle(0.5, 0.5 * (face.vertices[13].uv.y + face.vertices[14].uv.y));
    for (int step = 0; step < 3; ++step) {
        Ids next;
        for (size_t i = 0; i < ring.size(); ++i) {
            Vertex v = face.vertices[kLipLoops[3][i]];
            double across = std::sin(kPi * static_cast<double>(i % 10) / 10) * (i < 10 ? 1 : -1);
            v.at += dvec3(0, rise[step] * across, -depth[step]);
            v.at.x *= narrow[step];
            v.uv = middle + (v.uv - middle) * dvec2(0.9 + 0.1 * chart[step], chart[step]);
            v.weight[kMouth] = step == 0 ? 0.5 : 1;
            v.weight[kLip] = step == 0 ? 0.6 : 0;
            next.push_back(face.add(v));
        }
        face.addStrip(ring, next, true);
        ring = next;
    }
    for (uint32_t i = 0; i < 10; ++i) {  // upper against lower, corner to corner
        uint32_t a = ring[i], b = ring[i + 1], c = ring[(20 - i - 1) % 20], d = ring[(20 - i) % 20];
        bool mirrored = i >= 5;
        if (i == 0) face.addTriangle(a, b, c);
        if (i == 9) face.addTriangle(a, b, d);
        if (i == 0 || i == 9) continue;
        face.addTriangle(a, b, mirrored ? d : c);
        face.addTriangle(mirrored ? b : a, c, d);
    }
}

double ellipsoid(dvec3 p, dvec3 centre, dvec3 radii) {
    dvec3 q = (p - centre) / radii;
    double k = glm::length(q);
    return k < 1e-9 ? -radii.x : k * (k - 1) / glm::length(q / radii);
}

double smoothMin(double a, double b, double k) {
    double h = std::max(k - std::abs(a - b), 0.0) / k;
    return std::min(a, b) - h * h * k * 0.25;
}

double along(const std::array<dvec2, 6>& table, double y) {
    for (size_t i = 0; i + 1 < table.size(); ++i)
        if (y >= table[i + 1].x || i + 2 == table.size()) {
            double t = glm::clamp((y - table[i].x) / (table[i + 1].x - table[i].x), 0.0, 1.0);
            return glm::mix(table[i].y, table[i + 1].y, t);
        }
    return table.back().y;
}

// Approximate signed distance to a skull on a neck; the loft is moved to its surface.
double skullAndNeck(dvec3 p) {
    static const std::array<dvec2, 6> width = {{{0, 5.3}, {-6, 5.2}, {-10, 5.1}, {-14, 5.5}, {-17, 6.4}, {-20, 8.2}}};
    static const std::array<dvec2, 6> depth = {{{0, 4.8}, {-6, 4.9}, {-10, 5.1}, {-14, 5.3}, {-17, 5.6}, {-20, 6.0}}};
    static const std::array<dvec2, 6> middle = {{{0, -6.0}, {-6, -5.9}, {-10, -5.8}, {-14, -6.5}, {-17, -7.2}, {-20, -8.0}}};
    dvec2 q = dvec2(p.x, p.z - along(middle, p.y)) / dvec2(along(width, p.y), along(depth, p.y));
    double neck = (glm::length(q) - 1) * 5.2;
    neck = std::max(neck, p.y - 1.0);
    double cranium = ellipsoid(p, {0, 5.4, -4.5}, {7.6, 7.9, 9.6});
    double parietal = ellipsoid(p, {0, 7.2, -6.2}, {7.75, 6.2, 7.6});
    double frontal = ellipsoid(p, {0, 7.0, -1.6}, {7.1, 6.1, 6.75});
    double temples = ellipsoid(p, {0, 3.0, -4.4}, {7.7, 7.0, 7.4});
    double jaw = ellipsoid(p, {0, -4.4, -1.0}, {6.5, 5.0, 4.8});
    double skull = smoothMin(smoothMin(cranium, parietal, 1.0), smoothMin(frontal, temples, 1.0), 1.0);
    return smoothMin(smoothMin(skull, jaw, 1.6), neck, 3.2);
}

dvec3 slope(dvec3 p) {
    const double h = 1e-3;
    return dvec3(skullAndNeck(p + dvec3(h, 0, 0)) - skullAndNeck(p - dvec3(h, 0, 0)),
                 skullAndNeck(p + dvec3(0, h, 0)) - skullAndNeck(p - dvec3(0, h, 0)),
                 skullAndNeck(p + dvec3(0, 0, h)) - skullAndNeck(p - dvec3(0, 0, h))) /
           (2 * h);
}

dvec3 ontoSkull(dvec3 p) {
    for (int i = 0; i < 6; ++i) {
        dvec3 g = slope(p);
        p -= g * (skullAndNeck(p) / std::max(glm::dot(g, g), 0.05));
    }
    return p;
}

// An ear in its own plane, in cm: x backward, y up along its axis; ten vertices where it grows from the head, twenty around its rim.
constexpr dvec2 kEarRoot[10] = {{-0.95, -1.9}, {-1.05, -0.6}, {-1.05, 0.9}, {-0.7, 2.0},  {0.2, 2.3},
                                {0.9, 1.6},    {1.0, 0.5},    {0.8, -0.7},  {0.3, -1.75}, {-0.35, -2.25}};
constexpr dvec2 kEarRim[20] = {{-0.8, -1.75}, {-0.95, -1.1}, {-1.0, -0.45}, {-1.0, 0.25}, {-1.0, 0.95}, {-0.95, 1.65}, {-0.7, 2.3},
                               {-0.2, 2.8},   {0.45, 3.0},   {1.1, 2.85},   {1.62, 2.4},  {1.95, 1.8},  {2.05, 1.1},   {1.98, 0.35},
                               {1.78, -0.4},  {1.48, -1.1},  {1.08, -1.8},  {0.62, -2.4}, {0.05, -2.7}, {-0.5, -2.45}};
constexpr double kEarHeight[20] = {0.22, 0.25, 0.25, 0.25, 0.25, 0.30, 0.50, 0.76, 0.96, 1.08,
                                   1.16, 1.2,  1.2,  1.18, 1.1,  1.0,  0.88, 0.72, 0.52, 0.32};

dvec3 earPoint(double side, dvec2 p, double height) {
    const double lean = 0.22;
    p *= 1.06;
    double y = 0.75 + p.y * std::cos(lean) - p.x * std::sin(lean), z = -4.85 - p.x * std::cos(lean) - p.y * std::sin(lean);
    dvec3 on = ontoSkull({7.6, y, z});
    return {side * (on.x + height), y, z - 0.15 * height};
}

class Loft {
  public:
    explicit Loft(Surface& face) : face_(face) {
        for (const Ids& loop : boundaryLoops(face))
            if (std::find(loop.begin(), loop.end(), uint32_t{kChin}) != loop.end()) rings_.push_back(loop);
        auto chin = std::find(rings_[0].begin(), rings_[0].end(), uint32_t{kChin});
        std::rotate(rings_[0].begin(), chin, rings_[0].end());
    }
    bool fits() const { return rings_[0].size() == kMeridians; }
    void build() {
        place();
        relax();
        layInTile();
        for (int j = 0; j < kRings; ++j)
            for (int i = 0; i < kMeridians; ++i)
                if (!underEar(i, j)) face_.addStrip({id(i, j), id(i + 1, j)}, {id(i, j + 1), id(i + 1, j + 1)}, false);
        for (double side : {1.0, -1.0}) addEar(side);
    }

  private:
    static constexpr int kEarFirst = 9, kEarLast = 12;  // meridians counted from the chin
    uint32_t id(int i, int j) const { return rings_[j][(i + kMeridians) % kMeridians]; }
    Vertex& vertex(int i, int j) { return face_.vertices[id(i, j)]; }
    static int fromChin(int i) { return std::min(i, kMeridians - i); }
    static bool underEar(int i, int j) {
        bool left = i >= kEarFirst && i < kEarLast, right = i >= kMeridians - kEarLast && i < kMeridians - kEarFirst;
        return (left || right) && j >= 1 && j < 3;
    }
    // The ear's root, around the hole that the quads under it leave: up the front, down the back.
    static std::array<std::array<int, 2>, 10> earHole(double side) {
        std::array<std::array<int, 2>, 10> hole = {{{9, 1}, {10, 1}, {11, 1}, {12, 1}, {12, 2}, {12, 3}, {11, 3}, {10, 3}, {9, 3}, {9, 2}}};
        if (side < 0)
            for (auto& corner : hole) corner[0] = kMeridians - corner[0];
        return hole;
    }

    void place() {
        const dvec3 centre(0, 1, -5);
        for (int j = 1; j <= kRings; ++j) {
            Ids ring;
            for (int i = 0; i < kMeridians; ++i) {
                double angle = i * 2 * kPi / kMeridians, t = static_cast<double>(j) / kRings;
                dvec3 edge(7.6 * std::sin(angle), -19.4 - 0.5 * std::cos(angle), -7.8 + 5.9 * std::cos(angle));
                for (int k = 0; k < 6; ++k) edge = dvec3(ontoSkull(edge).x, edge.y, ontoSkull(edge).z);
                dvec3 start = face_.vertices[rings_[0][i]].at - centre, end = edge - centre;
                dvec3 middle = glm::normalize(glm::normalize(start) + glm::normalize(end) + dvec3(0, 0.4, -1.6) * (1 - std::cos(angle)));
                dvec3 way = glm::normalize(start) * (1 - t) * (1 - t) + middle * 2.0 * t * (1 - t) + glm::normalize(end) * t * t;
                Vertex v;
                v.at = j == kRings ? edge : ontoSkull(centre + glm::normalize(way) * glm::mix(glm::length(start), glm::length(end), t * t));
                v.at.x = i % (kMeridians / 2) == 0 ? 0 : v.at.x;
                v.weight[kLoft] = std::min(1.0, j / 3.0);
                ring.push_back(face_.add(v));
            }
            rings_.push_back(ring);
        }
    }

    // Evenly spread on skull and neck, and by the face a thin plate, so that no crease shows where they meet.
    void relax() {
        Surface sheet = face_;
        for (int j = 0; j < kRings; ++j)
            for (int i = 0; i < kMeridians; ++i) sheet.addStrip({id(i, j), id(i + 1, j)}, {id(i, j + 1), id(i + 1, j + 1)}, false);
        Neighbours around = neighboursOf(sheet);
        std::vector<bool> pinned(face_.vertices.size(), false);
        for (double side : {1.0, -1.0}) {
            auto hole = earHole(side);
            for (int k = 0; k < 10; ++k) {
                face_.vertices[id(hole[k][0], hole[k][1])].at = earPoint(side, kEarRoot[k], 0);
                pinned[id(hole[k][0], hole[k][1])] = true;
            }
        }
        std::vector<dvec3> first(face_.vertices.size()), second(face_.vertices.size());
        auto laplace = [&](uint32_t v, auto&& value) {
            dvec3 sum(0);
            for (uint32_t n : around[v]) sum += value(n);
            return sum / static_cast<double>(around[v].size()) - value(v);
        };
        const double draw[6] = {0, 0.0, 0.015, 0.06, 0.2, 0.4};
        for (int step = 0; step < 1500; ++step) {
            for (uint32_t v = 0; v < first.size(); ++v) first[v] = laplace(v, [&](uint32_t n) { return face_.vertices[n].at; });
            for (uint32_t v : rings_[kRings]) first[v] = dvec3(0);
            for (int j = 1; j < kRings; ++j)
                for (uint32_t v : rings_[j]) second[v] = laplace(v, [&](uint32_t n) { return first[n]; });
            for (int j = 1; j < kRings; ++j)
                for (uint32_t v : rings_[j]) {
                    if (pinned[v]) continue;
                    dvec3& p = face_.vertices[v].at;
                    p -= second[v] * 0.25;
                    if (j < 2) continue;
                    dvec3 g = glm::normalize(slope(p)), spread = first[v] - g * glm::dot(first[v], g);
                    p += spread * (j < 4 ? 0.02 : 0.2);
                    p -= g * (skullAndNeck(p) * (j < 6 ? draw[j] : 0.6));
                }
        }
    }

    // Along straight lines from the face's boundary to the tile's edge; near the face as fine as the face, coarser towards the nape.
    void layInTile() {
        for (int i = 0; i < kMeridians; ++i) {
            dvec2 from = vertex(i, 0).uv, way = from - dvec2(0.5);
            double reach = 0.488 / std::pow(std::pow(std::abs(way.x), 5.0) + std::pow(std::abs(way.y), 5.0), 0.2);
            dvec2 to = dvec2(0.5) + way * reach;
            double back = 0.5 * (1 - std::cos(i * 2 * kPi / kMeridians)), k = 0.3 + 2.0 * back;
            double beside = (fromChin(i) - 0.5 * (kEarFirst + kEarLast)) / 2.2, ear = std::exp(-beside * beside);  // an ear needs room
            for (int j = 1; j <= kRings; ++j) {
                double s = (j + 3 * ear * glm::clamp((j - 1) / 2.0, 0.0, 1.0)) / (kRings + 3 * ear);
                vertex(i, j).uv = glm::mix(from, to, (1 - std::exp(-k * s)) / (1 - std::exp(-k)));
            }
        }
    }

    void addEar(double side) {
        Ids root;
        dvec2 middle(0);
        for (auto corner : earHole(side)) {
            root.push_back(id(corner[0], corner[1]));
            middle += face_.vertices[root.back()].uv * 0.1;
        }
        constexpr int kSteps = 8;
        const double scale[kSteps] = {0, 0.95, 1.02, 0.92, 0.78, 0.62, 0.42, 0.2}, lift[kSteps] = {0, -0.4, 0.0, 0.14, -0.42, -0.02, 0, 0};
        const double chart[kSteps] = {0.82, 0.71, 0.61, 0.51, 0.42, 0.32, 0.22, 0.11};
        const dvec2 concha(-0.2, -0.15);
        std::vector<Ids> rings;
        for (int step = 0; step < kSteps; ++step) {
            Ids& ring = rings.emplace_back();
            for (int k = 0; k < 20; ++k) {
                dvec2 base = k % 2 == 0 ? kEarRoot[k / 2] : 0.5 * (kEarRoot[k / 2] + kEarRoot[(k / 2 + 1) % 10]);
                dvec2 chartBase = face_.vertices[root[k / 2]].uv;
                if (k % 2 == 1) chartBase = 0.5 * (chartBase + face_.vertices[root[(k / 2 + 1) % 10]].uv);
                bool front = k <= 4, lobe = k >= 16 && k <= 19;
                double height = kEarHeight[k] + lift[step] * (lobe ? 0.3 : std::min(1.0, 1.1 * kEarHeight[k]));
                dvec2 p = concha + (kEarRim[k] - concha) * scale[step];
                if (step == 0) {
                    p = glm::mix(base, kEarRim[k], 0.4);
                    height = front ? 0.03 : 0.22 * kEarHeight[k];
                } else if (front && step < 4) {
                    height = 0.05 + 0.05 * step;  // in front the face runs on into the ear
                } else if (front && step >= 4 && step <= 5) {
                    height = k >= 1 && k <= 3 ? (step == 4 ? 0.42 : 0.5) : 0.14;  // the tragus
                } else if (step == 6) {
                    height = lobe ? 0.25 : front ? -0.1 : 0.02;
                } else if (step == 7) {
                    height = -0.3;
                }
                Vertex v;
                v.at = earPoint(side, p, height);
                v.uv = middle + (chartBase - middle) * chart[step];
                v.weight[kEar] = 1;
                v.weight[kLoft] = 1;
                ring.push_back(face_.add(v));
            }
        }
        for (int k = 0; k < 10; ++k) {
            uint32_t a = root[k], b = root[(k + 1) % 10], c = rings[0][2 * k], d = rings[0][2 * k + 1], e = rings[0][(2 * k + 2) % 20];
            face_.addTriangle(a, c, d);
            face_.addTriangle(a, d, b);
            face_.addTriangle(b, d, e);
        }
        if (side < 0)  // a strip of the opposite direction is its mirror image
            for (Ids& ring : rings) std::reverse(ring.begin(), ring.end());
        for (int step = 0; step + 1 < kSteps; ++step) face_.addStrip(rings[step], rings[step + 1], true);
        Vertex canal;
        canal.at = earPoint(side, concha, -0.45);
        canal.uv = middle;
        canal.weight[kEar] = canal.weight[kLoft] = 1;
        uint32_t last = face_.add(canal);
        for (int k = 0; k < 20; ++k) face_.addTriangle(rings.back()[k], rings.back()[(k + 1) % 20], last);
    }

    Surface& face_;
    std::vector<Ids> rings_;
};

// The share of the jaw's motion: 0 on the upper lip, 1 on the lower lip, 1/2 at the corners, so that the mouth opens round.
double lipShare(size_t i) {
    double across = std::pow(std::sin(kPi * static_cast<double>(i % 10) / 10), 0.7);
    return i < 10 ? 0.5 - 0.5 * across : 0.5 + 0.5 * across;
}

// The share of the jaw's motion of each vertex: fixed on lips, chin and resting parts, harmonic in between, along edges, so that lips part.
void spreadJaw(Surface& cage) {
    std::vector<double> given(cage.vertices.size(), -1);
    for (size_t v = 0; v < given.size(); ++v) {
        const Vertex& vertex = cage.vertices[v];
        dvec3 p = vertex.at;
        if (p.y > -1.2 || vertex.weight[kEar] > 0 || (vertex.weight[kLoft] >= 1 && (p.z < -0.5 || p.y < -11.5))) given[v] = 0;
        if (vertex.weight[kLoft] == 0 && vertex.weight[kMouth] == 0 && p.y < -6.0 && std::abs(p.x) < 4.5) given[v] = 1;
    }
    for (const Ids& loop : kLipLoops)
        for (size_t i = 0; i < loop.size(); ++i) given[loop[i]] = lipShare(i);
    for (size_t v = 468; v < 468 + 60; ++v) {  // the mouth's three rings
        given[v] = lipShare((v - 468) % 20);
    }
    for (uint32_t v : {2U, 164U, 97U, 326U}) given[v] = 0;
    Neighbours around = neighboursOf(cage);
    for (size_t v = 0; v < given.size(); ++v) cage.vertices[v].weight[kJaw] = std::max(given[v], 0.0);
    for (int step = 0; step < 400; ++step)
        for (size_t v = 0; v < given.size(); ++v) {
            if (given[v] >= 0 || around[v].empty()) continue;
            double sum = 0;
            for (uint32_t n : around[v]) sum += cage.vertices[n].weight[kJaw];
            cage.vertices[v].weight[kJaw] = sum / static_cast<double>(around[v].size());
        }
}

}  // namespace

Result<Surface> readFace(const std::string& path) {
    Result<std::string> text = readFile(path);
    if (!text) return text.error();
    std::istringstream lines(*text);
    std::vector<dvec2> uvs;
    Surface face;
    std::string line, word;
    while (std::getline(lines, line)) {
        std::istringstream words(line);
        words >> word;
        dvec3 p(0);
        if (word == "v" && words >> p.x >> p.y >> p.z) face.add({p, dvec2(0), {}});
        if (word == "vt" && words >> p.x >> p.y) uvs.emplace_back(p.x, p.y);
        if (word != "f") continue;
        Triangle t{};
        for (uint32_t& v : t) {
            size_t uv = 0;
            char slash = 0;
            if (!(words >> v >> slash >> uv) || v < 1 || v > face.vertices.size() || uv < 1 || uv > uvs.size())
                return badInput(fmt::format("the face {} has a triangle that is not of the form 'f v/t v/t v/t': {}", path, line));
            face.vertices[--v].uv = uvs[uv - 1];
            std::string rest;
            std::getline(words, rest, ' ');
        }
        face.triangles.push_back(t);
    }
    if (face.vertices.size() != 468 || face.triangles.size() != 898)
        return badInput(fmt::format("the face {} has {} vertices and {} triangles, not the 468 and 898 of the canonical face model", path,
                                    face.vertices.size(), face.triangles.size()));
    return face;
}

Result<Surface> buildCage(const std::string& facePath) {
    Result<Surface> face = readFace(facePath);
    if (!face) return face.error();
    Surface cage = std::move(*face);
    layFaceInTile(cage);
    for (const Ids& loop : kLidLoops) dropInside(cage, loop);
    dropInside(cage, kLipLoops[3]);
    closeLips(cage);
    fillForehead(cage);
    Loft loft(cage);
    if (!loft.fits()) return badInput(fmt::format("the face {} has another boundary than the canonical face model", facePath));
    addMouth(cage);
    loft.build();
    cage.dropUnusedVertices();
    spreadJaw(cage);
    return cage;
}

}  // namespace rivulet::head
