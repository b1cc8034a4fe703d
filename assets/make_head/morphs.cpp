#include "assets/make_head/morphs.h"

#include <cmath>
#include <set>

#include "assets/make_head/noise.h"

namespace rivulet::head {
namespace {

constexpr double kJawOpens = 0.24;  // rad

// Radians by which the eyes turn to the left and up.
dvec2 gazeOf(const std::string& look) {
    const double sideways = look == "lookLeft" ? 1 : look == "lookRight" ? -1 : 0, up = look == "lookUp" ? 1 : look == "lookDown" ? -1 : 0;
    return kGazeTurns * dvec2(sideways, up);
}

// 0 at the lids, 1 away from them: motions of brows and cheeks must not move the lids off the eyes.
double awayFromLids(dvec3 p, bool above) {
    dvec2 d = dvec2(std::abs(p.x) - 3.17, p.y - 2.6) / dvec2(1.75, above ? 1.35 : 1.2);
    return smoothstep(0.75, 1.5, glm::length(d));
}

dvec3 jawTurned(dvec3 p, double angle) {
    const double y = 0.4, z = -3.0;
    dvec3 d = p - dvec3(p.x, y, z);
    return dvec3(p.x, y + d.y * std::cos(angle) - d.z * std::sin(angle), z + d.y * std::sin(angle) + d.z * std::cos(angle));
}

// Every face's half moves as its mirror image; `side` is +1 on the left.
dvec3 cheeks(dvec3 p, double side) {
    dvec3 lift = dvec3(0.05 * side, 0.42, 0.24) * bell(p, {3.7 * side, 0.2, 4.0}, {1.35, 1.15, 1.6});
    return lift * awayFromLids(p, false);
}

// Of the groove between two points, at a distance from its line.
double groove(dvec3 p, dvec3 from, dvec3 to, double width) {
    dvec3 along = to - from, d = p - from;
    double t = glm::dot(d, along) / glm::dot(along, along), off = glm::length(d - along * glm::clamp(t, 0.0, 1.0)) / width;
    return std::exp(-off * off) * smoothstep(-0.15, 0.2, t) * smoothstep(1.15, 0.75, t);
}

dvec3 brows(dvec3 p, double side, const std::string& name) {
    if (name == "browInnerUp") {
        dvec3 up = dvec3(-0.04 * side, 0.80, 0.06) * bell(p, {0.9 * side, 4.9, 5.2}, {1.15, 1.35, 2.0});
        // The forehead's skin, pushed up, folds across its middle.
        dvec3 fold = dvec3(0, 0, -0.030 + 0.045 * std::sin(p.y * 2 * kPi / 0.8)) * bell(p, {0.9 * side, 6.9, 5.8}, {1.2, 0.75, 2.0});
        return up * smoothstep(3.0, 4.5, p.y) + fold;
    }
    if (name == "browKnit") {
        dvec3 in = dvec3(-0.26 * side, -0.06, 0.05) * bell(p, {1.25 * side, 4.7, 5.2}, {0.85, 0.85, 2.0});
        dvec3 furrow = dvec3(0, 0, -0.11) * groove(p, {0.42 * side, 4.2, 5.6}, {0.50 * side, 5.5, 5.8}, 0.17);
        return (in + furrow) * smoothstep(3.2, 4.2, p.y) + dvec3(0, 0, 0.05) * bell(p, {0.9 * side, 4.8, 5.4}, {0.25, 0.6, 1.0});
    }
    dvec3 down = dvec3(-0.14 * side, -0.42, 0.08) * bell(p, {1.7 * side, 4.9, 5.1}, {1.0, 1.2, 2.0}) +
                 dvec3(0, -0.30, 0.02) * bell(p, {3.9 * side, 4.9, 4.5}, {1.3, 1.1, 2.0});
    return down * smoothstep(2.5, 5.0, p.y);
}

dvec3 mouth(dvec3 p, double side, const std::string& name) {
    double front = smoothstep(0.0, 2.5, p.z);
    if (name == "smile") {
        dvec3 corner = dvec3(0.62 * side, 0.50, -0.42) * bell(p, {2.5 * side, -4.25, 4.3}, {1.0, 1.0, 2.2});
        dvec3 fold = dvec3(0.18 * side, 0.34, 0.16) * bell(p, {3.6 * side, -2.2, 4.2}, {1.1, 1.3, 2.0});
        return (corner + fold) * front + 0.45 * cheeks(p, side);
    }
    if (name == "frown") {
        dvec3 corner = dvec3(0.10 * side, -0.62, -0.10) * bell(p, {2.5 * side, -4.4, 4.3}, {0.85, 0.95, 2.2});
        dvec3 chin = 0.5 * dvec3(0, 0.28, 0.12) * bell(p, {0, -6.6, 5.0}, {1.5, 0.9, 2.0});
        return (corner + chin) * front;
    }
    if (name == "mouthStretch") {  // wide, the lips drawn thin
        dvec3 corner = dvec3(0.46 * side, -0.20, -0.30) * bell(p, {2.5 * side, -4.35, 4.3}, {1.15, 0.9, 2.2});
        dvec3 thin = dvec3(0, -0.10 * (p.y + 4.25), -0.06) * bell(p, {1.2 * side, -4.25, 5.0}, {1.6, 0.7, 2.0});
        dvec3 fold = dvec3(0, 0, -0.10) * groove(p, {3.05 * side, -3.7, 4.2}, {3.25 * side, -5.6, 3.9}, 0.36);
        return (corner + fold) * front + thin * front * 0.5;
    }
    if (name == "upperLipRaise") {  // with the wings of the nose, and the fold from them to the corners
        dvec3 lip = dvec3(0.04 * side, 0.34, 0.06) * bell(p, {1.35 * side, -3.3, 5.4}, {0.85, 0.75, 1.6});
        dvec3 wing = dvec3(0.07 * side, 0.20, 0.0) * bell(p, {1.4 * side, -1.1, 5.7}, {0.5, 0.6, 1.0});
        dvec3 fold = dvec3(0, 0, -0.13) * groove(p, {1.95 * side, -1.6, 5.1}, {3.0 * side, -3.9, 4.4}, 0.33) +
                     dvec3(0.06 * side, 0.20, 0.16) * groove(p, {2.55 * side, -0.9, 4.9}, {3.6 * side, -3.2, 4.2}, 0.55);
        return (lip + wing + fold) * front;
    }
    if (name == "mouthPress") {  // lips together and drawn in
        double near = bell(p, {0.9 * side, -4.3, 5.2}, {1.5, 0.55, 1.5});
        dvec3 in = dvec3(0.03 * side, 0.34 * glm::clamp(-4.22 - p.y, -0.5, 0.5), -0.09) * near;
        return (in + dvec3(0, 0.10, 0.05) * bell(p, {0.6 * side, -6.3, 5.2}, {1.1, 0.7, 2.0})) * front;
    }
    // Pucker: towards the middle and forward.
    double near = bell(p, {0, -4.3, p.z}, {1.9, 1.25, 1.0}) * front;
    double drawn = near * 0.44 * std::abs(p.x) / (0.6 + 0.3 * std::abs(p.x));
    return side * p.x < 0 ? dvec3(0) : dvec3(-side * drawn, 0, 0.62 * near) * (p.x == 0 ? 0.5 : 1.0);
}

// The mentalis pushes chin and lower lip up; over it the skin is dimpled.
dvec3 chinRaised(dvec3 p, double jaw) {
    double front = smoothstep(0.0, 2.5, p.z), which = 0;
    dvec3 boss = dvec3(0, 0.52, 0.10) * bell(p, {0, -6.9, 5.0}, {1.4, 0.85, 2.0});
    dvec3 lip =
        dvec3(0, 0.16 + 0.12 * smoothstep(-4.4, -5.2, p.y), 0.26) * bell(p, {0, -5.0, 5.5}, {1.7, 0.62, 1.6}) * smoothstep(0.3, 0.8, jaw);
    dvec3 upper = dvec3(0, 0.10, 0.03) * bell(p, {0, -4.0, 5.6}, {1.5, 0.45, 1.6}) * smoothstep(0.6, 0.2, jaw);
    double dimple = smoothstep(0.75, 0.0, cells(dvec3(p.x, p.y, 0) * 1.45, 431, which)) * (0.4 + 0.6 * which);
    dvec3 dimples = dvec3(0, 0, -0.17) * (dimple * bell(p, {0, -6.7, 5.2}, {1.0, 0.6, 2.0}));
    dvec3 fold = dvec3(0, 0, -0.17) * bell(p, {0, -5.75, 5.2}, {1.3, 0.22, 2.0});  // between lip and chin
    return (boss + lip + upper + dimples + fold) * front;
}

// The larynx stands out of the throat; swallowed, it goes up by two thirds of its height, and the floor of the mouth with it.
dvec3 swallowed(dvec3 p) {
    auto larynx = [&](double y) { return 0.30 * bell(p, {0, y, p.z}, {0.85, 1.0, 1.0}); };
    double front = smoothstep(-4.0, -1.5, p.z) * smoothstep(-9.6, -10.6, p.y);
    return dvec3(0, 0.55, 0) * bell(p, {0, -12.6, p.z}, {1.6, 1.8, 1.0}) * front +
           dvec3(0, 0, 0.9) * ((larynx(-11.9) - larynx(-13.4)) * front);
}

struct LidPlace {
    int eye = -1;
    bool upper = false, onMargin = false;
};

std::vector<LidPlace> lidPlaces(const Surface& head, const std::array<Eye, 2>& eyes) {
    std::vector<LidPlace> places(head.vertices.size());
    for (int k = 0; k < 2; ++k) {
        const Eye& eye = eyes[k];
        for (uint32_t v = 0; v < places.size(); ++v) {
            dvec3 p = head.vertices[v].at;
            if (glm::distance(p, eye.centre) > 3.2 || p.z < eye.centre.z) continue;
            EyePoint e = eye.seen(p);
            places[v] = {k, e.up > eye.closingLine(e.out), false};
        }
        size_t n = eye.loop.size();
        for (size_t i = 0; i < n; ++i) {
            places[eye.loop[i]] = {k, i > n / 2, true};
            for (const auto& ring : eye.rings) places[ring[i]] = {k, i > n / 2, true};
        }
    }
    return places;
}

// A sliding lid unfolds: the remaining unevenness is smoothed, more for larger motion, and kept outside the eye.
void unfold(std::vector<dvec3>& morph, const Surface& head, const Neighbours& around, const std::vector<LidPlace>& places, const Eye& eye,
            int k) {
    std::vector<uint32_t> moved;
    for (uint32_t v = 0; v < morph.size(); ++v)
        if (places[v].eye == k && !places[v].onMargin && glm::length(morph[v]) > 5e-3) moved.push_back(v);
    std::vector<dvec3> next = morph;
    std::vector<double> amount(morph.size(), 0);
    for (uint32_t v : moved) amount[v] = 0.6 * smoothstep(0.02, 0.2, glm::length(morph[v]));
    for (int step = 0; step < 14; ++step) {
        for (uint32_t v : moved) {
            dvec3 p = head.vertices[v].at + morph[v], sum(0);
            for (uint32_t n : around[v]) sum += head.vertices[n].at + morph[n];
            p += amount[v] * (sum / static_cast<double>(around[v].size()) - p);
            EyePoint e = eye.seen(p);
            e.height = std::max(e.height, 0.16);
            next[v] = eye.placed(e) - head.vertices[v].at;
        }
        for (uint32_t v : moved) morph[v] = next[v];
    }
}

}  // namespace

std::vector<std::vector<dvec3>> makeMorphs(const Surface& head, const std::array<Eye, 2>& eyes) {
    std::vector<LidPlace> places = lidPlaces(head, eyes);
    auto lids = [&](uint32_t v, int eye, double upper, double lower) {
        dvec3 p = head.vertices[v].at;
        const LidPlace& place = places[v];
        return place.eye == eye ? eyes[eye].lidsMoved(p, place.upper, place.onMargin, upper, lower) - p : dvec3(0);
    };
    // The upper lid goes most of the way with a look down, and both lie on the cornea wherever it is.
    auto followed = [&](uint32_t v, int eye, const std::string& name) {
        dvec3 p = head.vertices[v].at;
        const LidPlace& place = places[v];
        if (place.eye != eye) return dvec3(0);
        double upper = name == "lookDown" ? 0.55
                       : name == "lookUp" ? -0.30
                                          : 0,
               lower = name == "lookDown" ? -0.45
                       : name == "lookUp" ? 0.30
                                          : 0;
        return eyes[eye].raisedOver(eyes[eye].lidsMoved(p, place.upper, place.onMargin, upper, lower), gazeOf(name)) - p;
    };
    static const std::set<std::string> kMouth = {"smile", "frown", "mouthPucker", "mouthStretch", "mouthPress", "upperLipRaise"};
    Neighbours around = neighboursOf(head);
    std::vector<std::vector<dvec3>> morphs;
    for (const std::string& name : kMorphNames) {
        std::vector<dvec3>& morph = morphs.emplace_back(head.vertices.size(), dvec3(0));
        for (uint32_t v = 0; v < morph.size(); ++v) {
            const Vertex& vertex = head.vertices[v];
            dvec3 p = vertex.at;
            for (double side : {1.0, -1.0}) {
                int k = side > 0 ? 0 : 1;
                bool own = name.ends_with(k == 0 ? "Left" : "Right");
                if (name.starts_with("blink") && own) morph[v] += lids(v, k, 1, 1);
                if (name.starts_with("squint") && own) {
                    dvec3 cheek = 0.45 * cheeks(p, side) +
                                  dvec3(0, -0.10, 0) * bell(p, {3.4 * side, 4.7, 4.7}, {1.5, 0.8, 2.0}) * awayFromLids(p, true);
                    morph[v] += lids(v, k, 0.22, 0.85) + cheek;
                }
                if (name.starts_with("brow")) morph[v] += brows(p, side, name);
                if (name.starts_with("look")) morph[v] += followed(v, k, name);
                if (name == "cheekRaise") morph[v] += cheeks(p, side) + lids(v, k, 0.0, 0.5);
                if (kMouth.contains(name)) morph[v] += mouth(p, side, name);
            }
            if (name == "chinRaise") morph[v] = chinRaised(p, vertex.weight[kJaw]);
            if (name == "swallow") morph[v] = swallowed(p);
            if (name == "mouthOpen") morph[v] = jawTurned(p, kJawOpens * vertex.weight[kJaw]) - p;
        }
        for (int k = 0; k < 2; ++k)
            if (name == (k == 0 ? "blinkLeft" : "blinkRight")) unfold(morph, head, around, places, eyes[k], k);
        for (dvec3& d : morph)
            if (glm::length(d) < 1.5e-3) d = dvec3(0);  // smaller ones are not seen, and they are many
    }
    return morphs;
}

std::vector<std::vector<dvec3>> lashMorphs(const Part& lashes, const std::vector<Lash>& ofVertex, const Surface& head, const Eye& eye,
                                           const std::vector<std::vector<dvec3>>& skin, const std::vector<dvec3>& wet) {
    std::vector<std::vector<dvec3>> morphs;
    for (size_t k = 0; k < skin.size(); ++k) {
        const std::vector<dvec3>& morph = skin[k];
        std::vector<dvec3>& own = morphs.emplace_back(lashes.positions.size(), dvec3(0));
        if (kMorphNames[k] == (eye.side > 0 ? "brimLeft" : "brimRight"))
            for (size_t v = 0; v < own.size(); ++v) own[v] = wet[v] - lashes.positions[v];
        for (size_t v = 0; v < own.size(); ++v) {
            uint32_t root = ofVertex[v].root;
            if (morph[root] == dvec3(0)) continue;
            // A lash turns with its lid about the eyeball's centre.
            dvec3 rest = head.vertices[root].at, d = lashes.positions[v] - eye.centre;
            double turn = eye.seen(rest + morph[root]).up - eye.seen(rest).up;
            dvec3 turned(d.x, d.y * std::cos(turn) + d.z * std::sin(turn), d.z * std::cos(turn) - d.y * std::sin(turn));
            own[v] = turned - d;
        }
    }
    return morphs;
}

std::vector<std::vector<dvec3>> eyeMorphs(const Part& part, const Eye& eye) {
    std::vector<std::vector<dvec3>> morphs;
    for (const std::string& name : kMorphNames) {
        std::vector<dvec3>& own = morphs.emplace_back();
        for (const dvec3& p : part.positions)
            own.push_back(name.starts_with("look") ? turned(p - eye.centre, gazeOf(name)) + eye.centre - p : dvec3(0));
    }
    return morphs;
}

std::vector<std::vector<dvec3>> carriedMorphs(const std::vector<uint32_t>& roots, const std::vector<std::vector<dvec3>>& skin) {
    std::vector<std::vector<dvec3>> morphs;
    for (const auto& morph : skin) {
        std::vector<dvec3>& own = morphs.emplace_back();
        for (const uint32_t root : roots) own.push_back(morph[root]);
    }
    return morphs;
}

std::vector<std::vector<dvec3>> jawMorphs(const Part& part, const std::vector<double>& jaw) {
    std::vector<std::vector<dvec3>> morphs;
    for (const std::string& name : kMorphNames) {
        std::vector<dvec3>& own = morphs.emplace_back(part.positions.size(), dvec3(0));
        if (name != "mouthOpen") continue;
        for (size_t v = 0; v < own.size(); ++v) own[v] = jawTurned(part.positions[v], kJawOpens * jaw[v]) - part.positions[v];
    }
    return morphs;
}

}  // namespace rivulet::head
