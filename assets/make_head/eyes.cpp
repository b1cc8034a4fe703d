#include "assets/make_head/eyes.h"

#include <algorithm>
#include <cmath>

#include "assets/make_head/cage.h"
#include "assets/make_head/noise.h"

namespace rivulet::head {
namespace {

constexpr dvec3 kEyeCentre(3.17, 2.68, 2.60);
constexpr double kCorneaRadius = 0.78, kCorneaCentre = 0.535;  // its sphere's centre lies before the eyeball's
constexpr double kLidThickness = 0.17;
constexpr double kInner = -1.36, kOuter = 1.32;  // the corners, outward from the eyeball's centre

// The margin's edge as seen from the front, and its height above the eye: an almond whose inner corner runs out flat over the tear lake.
EyePoint marginEdge(const Eye& eye, bool upper, double t) {
    double base = glm::mix(-0.15, 0.07, t);
    double arch =
        upper ? 0.51 * std::pow(std::sin(kPi * std::pow(t, 0.92)), 0.84) : -0.48 * std::pow(std::sin(kPi * std::pow(t, 1.2)), 0.92);
    arch *= glm::mix(0.62, 1.0, smoothstep(0.0, 0.22, t));
    double x = glm::mix(kInner, kOuter, t), y = base + arch;
    double lake = std::max(0.0, 1 - t / 0.27), tail = std::max(0.0, 1 - (1 - t) / 0.2);
    double height = kLidThickness + 0.36 * lake * lake + 0.05 * tail * tail;
    double r = kEyeRadius + height;
    EyePoint e;
    for (int i = 0; i < 4; ++i) {
        double z = std::sqrt(std::max(r * r - x * x - y * y, 0.01));
        e = eye.seen(eye.centre + dvec3(eye.side * x, y, z));
        r = eyeSurface(e.out, e.up) + height;
    }
    e.height = height;
    return e;
}

double atOut(const std::vector<EyePoint>& margin, double out, double EyePoint::*value) {
    if (out <= margin.front().out) return margin.front().*value;
    for (size_t i = 0; i + 1 < margin.size(); ++i)
        if (out <= margin[i + 1].out) {
            double t = (out - margin[i].out) / std::max(margin[i + 1].out - margin[i].out, 1e-9);
            return glm::mix(margin[i].*value, margin[i + 1].*value, t);
        }
    return margin.back().*value;
}

// Moves the surroundings of the lids with them: fixed at the edge, 0 beyond `reach`, a thin plate in between.
void carryAlong(Surface& head, const Neighbours& around, const Eye& eye, const std::vector<dvec3>& edge, double reach) {
    std::vector<uint32_t> region;
    std::vector<char> state(head.vertices.size(), 0);  // 1: free, 2: fixed
    for (uint32_t v = 0; v < head.vertices.size(); ++v) {
        double d = 1e9;
        for (uint32_t l : eye.loop) d = std::min(d, glm::distance(head.vertices[v].at, head.vertices[l].at));
        if (d < reach) state[v] = 1;
    }
    for (uint32_t l : eye.loop) state[l] = 2;
    for (uint32_t v = 0; v < state.size(); ++v)
        if (state[v] == 1) region.push_back(v);
    std::vector<dvec3> move(head.vertices.size(), dvec3(0)), bend(move);
    for (size_t i = 0; i < eye.loop.size(); ++i) move[eye.loop[i]] = edge[i] - head.vertices[eye.loop[i]].at;
    auto laplace = [&](const std::vector<dvec3>& f, uint32_t v) {
        dvec3 sum(0);
        for (uint32_t n : around[v]) sum += f[n];
        return sum / static_cast<double>(around[v].size()) - f[v];
    };
    for (int step = 0; step < 300; ++step)  // a membrane first: a good start for the plate
        for (uint32_t v : region) move[v] += laplace(move, v);
    for (int step = 0; step < 1500; ++step) {
        for (uint32_t v : region) bend[v] = laplace(move, v);
        for (uint32_t v : region) move[v] -= 0.25 * laplace(bend, v);
    }
    for (uint32_t v = 0; v < move.size(); ++v) head.vertices[v].at += move[v];
}

// Lids lie on the eye, and the upper one folds above its edge.
void wrapLids(Surface& head, const Eye& eye) {
    for (Vertex& vertex : head.vertices) {
        if (glm::distance(vertex.at, eye.centre) > 2.6 || vertex.at.z < eye.centre.z + 0.1) continue;
        EyePoint e = eye.seen(vertex.at);
        double least = kLidThickness;
        if (e.height < least + 0.1) {  // a soft maximum
            double d = std::max(e.height - least, -0.4);
            e.height = least + 0.5 * (d + std::sqrt(d * d + 0.0016)) - (d > 0 ? 0.5 * (std::sqrt(d * d + 0.0016) - d) : 0.0);
            e.height = std::max(e.height, least);
        }
        double upEdge = eye.margin(true, e.out), above = (e.up - upEdge) * (kEyeRadius + e.height);
        double t = (e.out - eye.upper.front().out) / (eye.upper.back().out - eye.upper.front().out);
        if (t > 0.02 && t < 1.12 && e.up > eye.closingLine(e.out)) {
            double fold = 0.36 * std::pow(std::sin(kPi * glm::clamp(0.12 + 0.8 * t, 0.0, 1.0)), 0.5);
            double fade = smoothstep(0.02, 0.25, t) * (1 - smoothstep(0.85, 1.12, t));
            double plate = smoothstep(0.0, 0.08, above) * (1 - smoothstep(fold * 0.8, fold * 1.25, above));
            double flat = atOut(eye.upper, e.out, &EyePoint::height) + 0.03;
            e.height = glm::mix(e.height, std::min(e.height, flat), 0.7 * fade * plate);
            double from = above - fold;
            e.height += fade * (0.05 * std::exp(-(from - 0.2) * (from - 0.2) / 0.02) - 0.035 * std::exp(-from * from / 0.004));
        }
        vertex.at = eye.placed(e);
    }
}

void addMargins(Surface& head, Eye& eye) {
    // Along the surface away from the slit, height above the eye, how much of a corner's extra height stays, and the place in the chart.
    struct Step {
        double away, height, corner, chart;
    };
    static const Step steps[] = {{-0.012, 0.150, 1.0, 0.07},  {-0.023, 0.120, 0.97, 0.14}, {-0.027, 0.092, 0.92, 0.21},
                                 {-0.022, 0.064, 0.85, 0.28}, {-0.006, 0.046, 0.75, 0.35}, {0.03, kLidGap, 0.6, 0.42},
                                 {0.13, kLidGap, 0.4, 0.5},   {0.30, kLidGap, 0.2, 0.6},   {0.50, 0.042, 0.1, 0.7}};
    size_t n = eye.loop.size();
    dvec2 low(1e9), high(-1e9);
    dvec3 middle(0);
    for (uint32_t v : eye.loop) {
        low = glm::min(low, head.vertices[v].uv);
        high = glm::max(high, head.vertices[v].uv);
        middle += head.vertices[v].at / static_cast<double>(n);
    }
    dvec2 centre = 0.5 * (low + high);
    std::vector<uint32_t> last = eye.loop;
    if (eye.side < 0) std::reverse(last.begin(), last.end());
    for (const Step& step : steps) {
        std::vector<uint32_t> ring;
        for (size_t i = 0; i < n; ++i) {
            Vertex v = head.vertices[eye.loop[i]];
            dvec3 before = head.vertices[eye.loop[(i + n - 1) % n]].at, after = head.vertices[eye.loop[(i + 1) % n]].at;
            dvec3 outward = glm::normalize(v.at - eye.centre), away = glm::normalize(glm::cross(after - before, outward));
            if (glm::dot(away, v.at - middle) < 0) away = -away;
            EyePoint edge = eye.seen(v.at), e = eye.seen(v.at + away * step.away);
            e.height = step.height + std::max(edge.height - kLidThickness, 0.0) * step.corner;
            v.at = eye.placed(e);
            v.uv += step.chart * (dvec2(centre.x + 0.8 * (v.uv.x - centre.x), centre.y) - v.uv);
            v.weight[kRim] = smoothstep(0.0, 0.2, step.chart);
            ring.push_back(head.add(v));
        }
        eye.rings.push_back(ring);
        if (eye.side < 0) std::reverse(ring.begin(), ring.end());  // a strip that runs the other way is its mirror image
        head.addStrip(last, ring, true);
        last = ring;
    }
}

}  // namespace

CornerFlesh cornerFlesh(double t, double v) {
    double which = 0;
    const dvec3 p(t / 0.021, v * 3.0, 0.5);
    const double lump = smoothstep(0.75, 0.1, cells(p, 401, which));
    const dvec2 off((t - 0.072) / 0.052, (v - 0.5) / 0.50);
    CornerFlesh flesh;
    flesh.caruncle = smoothstep(1.25, 0.55, glm::length(off));
    flesh.along = t - 0.035 * (2 * v - 1) * (2 * v - 1);
    const double crest = 0.112, from = (flesh.along - crest) / (flesh.along < crest ? 0.010 : 0.018);
    flesh.plica = std::exp(-from * from) * smoothstep(-0.2, 0.15, v) * smoothstep(1.2, 0.85, v);
    flesh.lump = flesh.caruncle * lump * (0.5 + 0.5 * which);
    flesh.height = 0.045 * flesh.caruncle + 0.022 * flesh.lump + 0.030 * flesh.plica;
    return flesh;
}

dvec2 fleshUv(double along, double across) { return dvec2(0.006) + 0.125 * dvec2(along, across); }

dvec3 turned(dvec3 p, dvec2 gaze) {
    const double y = p.y * std::cos(gaze.y) + p.z * std::sin(gaze.y), z = p.z * std::cos(gaze.y) - p.y * std::sin(gaze.y);
    return {p.x * std::cos(gaze.x) + z * std::sin(gaze.x), y, z * std::cos(gaze.x) - p.x * std::sin(gaze.x)};
}

namespace {

// `forward`: cosine of the angle to the direction of sight.
double surfaceBy(double forward) {
    double under = kCorneaRadius * kCorneaRadius - kCorneaCentre * kCorneaCentre * (1 - forward * forward);
    double cornea = forward > 0 ? kCorneaCentre * forward + std::sqrt(std::max(under, 0.0)) : 0;
    double d = cornea - kEyeRadius;
    return kEyeRadius + 0.5 * (d + std::sqrt(d * d + 1e-4));
}

}  // namespace

double eyeSurface(double out, double up) { return surfaceBy(std::cos(out + kInward) * std::cos(up)); }

dvec3 Eye::raisedOver(dvec3 p, dvec2 gaze) const {
    EyePoint e = seen(p);
    if (p.z < centre.z || e.height > 1) return p;
    const dvec3 towards = (p - centre) / glm::length(p - centre), sight = turned({-side * std::sin(kInward), 0, std::cos(kInward)}, gaze);
    const double rise = surfaceBy(glm::dot(towards, sight)) - eyeSurface(e.out, e.up);
    // Where the cornea leaves, a lid sinks less than it: it is thick.
    e.height += (rise > 0 ? rise : 0.5 * rise) * (1 - smoothstep(0.25, 0.9, e.height));
    return placed(e);
}

EyePoint Eye::seen(dvec3 p) const {
    dvec3 d = p - centre;
    double r = glm::length(d);
    EyePoint e;
    e.out = std::atan2(side * d.x, d.z);
    e.up = std::asin(glm::clamp(d.y / r, -1.0, 1.0));
    e.height = r - eyeSurface(e.out, e.up);
    return e;
}

dvec3 Eye::placed(const EyePoint& e) const {
    double r = eyeSurface(e.out, e.up) + e.height;
    return centre + r * dvec3(side * std::sin(e.out) * std::cos(e.up), std::sin(e.up), std::cos(e.out) * std::cos(e.up));
}

double Eye::margin(bool upperLid, double out) const { return atOut(upperLid ? upper : lower, out, &EyePoint::up); }

double Eye::closingLine(double out) const {
    double low = margin(false, out), high = margin(true, out);
    return low + 0.22 * (high - low);
}

dvec3 Eye::lidsMoved(dvec3 p, bool upperLid, bool onMargin, double upperShare, double lowerShare) const {
    double share = upperLid ? upperShare : lowerShare;
    EyePoint e = seen(p);
    if (share == 0 || std::abs(e.out) > 1.45 || p.z < centre.z) return p;
    double rest = margin(upperLid, e.out), closed = closingLine(e.out);
    // At the middle of a margin its front bulges past its edge by a quarter of a millimetre: lids meet there, not at their edges.
    closed += (upperLid ? 0.022 : -0.022) * smoothstep(0.0, 0.12, margin(true, e.out) - margin(false, e.out));
    double edgeHeight = atOut(upperLid ? upper : lower, e.out, &EyePoint::height);
    double reach = upperLid ? 0.42 : -0.42, beyond = (e.up - rest) / reach;
    share *= 1 - smoothstep(0.65, 1.25, e.height);  // the bridge of the nose is in the lids' way, but no lid
    double travel = (closed - rest) * share;
    if (beyond <= 0 || onMargin) {
        e.up += travel;
        return placed(e);
    }
    if (beyond >= 1) return p;
    double keep = 1 - smoothstep(0.0, 1.0, beyond);
    double moved = e.up + travel * keep;
    // The skin is drawn over the eye as a sheet: low near the edge, as high as it was where nothing moves.
    double along = glm::clamp((moved - rest - travel) / (reach - travel), 0.0, 1.0);
    double farHeight = std::max(e.height, edgeHeight);
    double sheet = glm::mix(edgeHeight + 0.02, farHeight, smoothstep(0.1, 1.0, along));
    e.up = moved;
    double open = smoothstep(0.0, 0.25, margin(true, e.out) - margin(false, e.out));
    e.height = glm::mix(e.height, std::min(e.height, sheet), std::max(share, 0.0) * keep * open);
    return placed(e);
}

std::array<Eye, 2> fitLids(Surface& head) {
    std::array<Eye, 2> eyes;
    std::vector<std::vector<uint32_t>> loops = boundaryLoops(head);
    Neighbours around = neighboursOf(head);
    for (int k = 0; k < 2; ++k) {
        Eye& eye = eyes[k];
        eye.side = k == 0 ? 1 : -1;
        eye.centre = kEyeCentre * dvec3(eye.side, 1, 1);
        for (auto& loop : loops)
            if (auto corner = std::find(loop.begin(), loop.end(), uint32_t(kOuterCorner[k])); corner != loop.end()) {
                std::rotate(loop.begin(), corner, loop.end());
                eye.loop = loop;
            }
        size_t n = eye.loop.size();
        if (head.vertices[eye.loop[n / 4]].at.y > head.vertices[eye.loop[3 * n / 4]].at.y)
            std::reverse(eye.loop.begin() + 1, eye.loop.end());
        double inner = head.vertices[kInnerCorner[k]].at.x, outer = head.vertices[kOuterCorner[k]].at.x;
        std::vector<dvec3> edge;
        for (size_t i = 0; i < n; ++i) {
            double t = glm::clamp((head.vertices[eye.loop[i]].at.x - inner) / (outer - inner), 0.0, 1.0);
            edge.push_back(eye.placed(marginEdge(eye, i > n / 2, t)));
        }
        for (int i = 0; i <= 64; ++i) {
            eye.lower.push_back(marginEdge(eye, false, i / 64.0));
            eye.upper.push_back(marginEdge(eye, true, i / 64.0));
        }
        carryAlong(head, around, eye, edge, 1.5);
        std::vector<dvec3> kept;
        for (uint32_t v : eye.loop) kept.push_back(head.vertices[v].at);
        wrapLids(head, eye);
        for (size_t i = 0; i < n; ++i) head.vertices[eye.loop[i]].at = kept[i];
    }
    for (Eye& eye : eyes) addMargins(head, eye);
    return eyes;
}

namespace {

// A surface of revolution about the direction of sight, which turns a little inward; `profile` gives angle from it, distance and UV radius.
struct Latitude {
    double angle, distance, chart;
};
Part revolved(const Eye& eye, const std::vector<Latitude>& profile, std::string name, std::string material) {
    constexpr int kAround = 48;
    const double inward = kInward * eye.side;
    Part part;
    part.name = std::move(name);
    part.material = std::move(material);
    auto put = [&](double angle, double turn, double distance, double chart) {
        dvec3 d(std::sin(angle) * std::cos(turn), std::sin(angle) * std::sin(turn), std::cos(angle));
        d = dvec3(d.x * std::cos(inward) - d.z * std::sin(inward), d.y, d.x * std::sin(inward) + d.z * std::cos(inward));
        part.positions.push_back(eye.centre + d * distance);
        part.uvs.emplace_back(0.5 + eye.side * chart * std::cos(turn), 0.5 + chart * std::sin(turn));
    };
    put(0, 0, profile[0].distance, 0);
    for (size_t j = 1; j < profile.size(); ++j)
        for (int i = 0; i < kAround; ++i) put(profile[j].angle, i * 2 * kPi / kAround, profile[j].distance, profile[j].chart);
    for (uint32_t i = 0; i < kAround; ++i) part.triangles.push_back({0, 1 + i, 1 + (i + 1) % kAround});
    for (uint32_t j = 1; j + 1 < profile.size(); ++j)
        for (uint32_t i = 0; i < kAround; ++i) {
            uint32_t a = 1 + (j - 1) * kAround + i, b = 1 + (j - 1) * kAround + (i + 1) % kAround;
            part.triangles.push_back({a, a + kAround, b + kAround});
            part.triangles.push_back({a, b + kAround, b});
        }
    part.normals = normalsOf(part.positions, part.triangles);
    return part;
}

}  // namespace

Part makeEyeball(const Eye& eye) {
    const double limbus = std::asin(kLimbusRadius / kEyeRadius), plane = kEyeRadius * std::cos(limbus);
    std::vector<Latitude> profile = {{0, plane - 0.032, 0}};
    auto chart = [](double angle) { return 0.5 * std::sqrt(angle / kPi); };
    constexpr int kIrisRows = 6, kWhiteRows = 20;
    for (int j = 1; j <= kIrisRows; ++j) {  // the iris: a shallow bowl behind the cornea
        double share = static_cast<double>(j) / kIrisRows, r = kLimbusRadius * share * 0.995, depth = 0.032 * (1 - std::pow(share, 4.0));
        double z = plane - depth;
        profile.push_back({std::atan2(r, z), std::hypot(r, z), chart(limbus * share * 0.995)});
    }
    for (int j = 0; j <= kWhiteRows; ++j) {
        double angle = glm::mix(limbus, kPi - 0.02, std::pow(static_cast<double>(j) / kWhiteRows, 1.3));
        profile.push_back({angle, kEyeRadius - (j == 0 ? 0.001 : 0), chart(angle)});
    }
    return revolved(eye, profile, eye.side > 0 ? "eyeLeft" : "eyeRight", "eye");
}

Part makeCornea(const Eye& eye) {
    const double edge = std::asin(kLimbusRadius / kEyeRadius) * 1.16;
    std::vector<Latitude> profile;
    constexpr int kRows = 14;
    for (int j = 0; j <= kRows; ++j) {
        double share = static_cast<double>(j) / kRows, angle = edge * share;
        double r = eyeSurface(angle - kInward, 0) - 0.004 * smoothstep(0.85, 1.0, share);
        profile.push_back({angle, r, 0.5 * share});
    }
    return revolved(eye, profile, eye.side > 0 ? "corneaLeft" : "corneaRight", "cornea");
}

Part makeCaruncle(const Eye& eye) {
    Part part;
    part.name = eye.side > 0 ? "caruncleLeft" : "caruncleRight";
    part.material = "caruncle";
    // A sheet between the lids of the inner corner, tucked behind both: at the corner as high as their inner edges, then down onto the
    // white, where it ends below its surface. On it the caruncle, a lumpy mound, and the plica, a crescent that opens towards the iris.
    constexpr uint32_t kAlong = 30, kAcross = 24;
    const double last = static_cast<double>(eye.lower.size() - 1);
    for (uint32_t j = 0; j <= kAlong; ++j)
        for (uint32_t i = 0; i <= kAcross; ++i) {
            const double t = kFleshEnd * j / kAlong, v = glm::mix(-kFleshTuck, 1 + kFleshTuck, static_cast<double>(i) / kAcross),
                         at = t * last;
            const auto k = static_cast<size_t>(at);
            const EyePoint &low = eye.lower[k], &high = eye.upper[k], &low2 = eye.lower[k + 1], &high2 = eye.upper[k + 1];
            const double share = at - static_cast<double>(k), lowUp = glm::mix(low.up, low2.up, share),
                         highUp = glm::mix(high.up, high2.up, share), beyond = std::max({-v, v - 1, 0.0});
            EyePoint e;
            e.out = 0.5 * (glm::mix(low.out, low2.out, share) + glm::mix(high.out, high2.out, share));
            e.up = glm::mix(lowUp, highUp, v) + (v < 0 ? -0.05 : 0.05) * beyond;
            const double corner = std::max(glm::mix(low.height, low2.height, share) - kLidThickness, 0.0);
            const CornerFlesh flesh = cornerFlesh(t, v);
            e.height = 0.62 * corner + 0.03 - 0.10 * smoothstep(0.105, 0.165, flesh.along) + flesh.height - (0.12 + 0.3 * corner) * beyond;
            part.positions.push_back(eye.placed(e));
            part.uvs.push_back(fleshUv(t / kFleshEnd, (v + kFleshTuck) / (1 + 2 * kFleshTuck)));
        }
    for (uint32_t j = 0; j < kAlong; ++j)
        for (uint32_t i = 0; i < kAcross; ++i) {
            const uint32_t p = j * (kAcross + 1) + i, q = p + kAcross + 1;
            Triangle one = {p, q, q + 1}, two = {p, q + 1, p + 1};
            if (eye.side < 0) std::swap(one[1], one[2]), std::swap(two[1], two[2]);
            part.triangles.push_back(one);
            part.triangles.push_back(two);
        }
    part.normals = normalsOf(part.positions, part.triangles);
    return part;
}

Part makeLashes(const Eye& eye, const Surface& head, std::vector<Lash>& ofVertex) {
    Part part;
    part.name = eye.side > 0 ? "lashesLeft" : "lashesRight";
    part.material = "lashes";
    size_t n = eye.loop.size();
    uint32_t seed = 12345;
    auto chance = [&] {
        seed = seed * 1664525u + 1013904223u;
        return (seed >> 8) / 16777216.0;
    };
    for (bool upper : {true, false}) {
        int count = upper ? 84 : 44;
        for (int l = 0; l < count; ++l) {
            double t = glm::clamp((l + 0.5 + 0.7 * (chance() - 0.5)) / count, 0.0, 1.0);  // inner to outer corner
            t = upper ? 0.10 + 0.885 * t : 0.2 + 0.76 * t;
            double at = static_cast<double>(n) * (upper ? 0.5 + 0.5 * t : 0.5 - 0.5 * t);
            auto i = static_cast<size_t>(at);
            double between = at - static_cast<double>(i);
            const std::vector<uint32_t>& ring = eye.rings[0];
            dvec3 p = head.vertices[ring[i % n]].at, q = head.vertices[ring[(i + 1) % n]].at, root = glm::mix(p, q, between);
            dvec3 outward = glm::normalize(root - eye.centre),
                  run = glm::normalize(q - p) * (upper ? 1.0 : -1.0);  // towards the outer corner
            dvec3 lift = dvec3(0, upper ? 1 : -1, 0) - outward * outward.y * (upper ? 1.0 : -1.0);
            double length =
                (upper ? 0.82 * glm::mix(0.5, 1.0, smoothstep(0.0, 0.55, t)) : 0.42 * glm::mix(0.6, 1.0, t)) * (0.75 + 0.4 * chance());
            double fan = 1.0 * (t - 0.40) + 0.22 * (chance() - 0.5), curl = (upper ? 0.95 : 0.40) + 0.25 * chance();
            root -= outward * 0.015;
            constexpr int kJoints = 6;
            auto first = static_cast<uint32_t>(part.positions.size());
            for (int s = 0; s < kJoints; ++s) {
                double u = static_cast<double>(s) / (kJoints - 1);
                dvec3 on = root + length * (outward * (0.92 * u - 0.18 * u * u) + run * (fan * (0.5 * u + 0.4 * u * u)) +
                                            lift * ((upper ? -0.34 : -0.02) * u + curl * u * u));
                double half = 0.0075 * (1 - 0.85 * u) * (upper ? 1.0 : 0.7);
                for (double sign : {-1.0, 1.0}) {
                    part.positions.push_back(on + run * (sign * half));
                    part.uvs.emplace_back(0.5 + 0.5 * sign, u);
                    part.normals.push_back(outward);
                    ofVertex.push_back({ring[i % n], upper, l, u});
                }
            }
            for (uint32_t s = 0; s + 1 < kJoints; ++s) {
                uint32_t a = first + 2 * s;
                part.triangles.push_back({a, a + 1, a + 2});
                part.triangles.push_back({a + 1, a + 3, a + 2});
            }
        }
    }
    return part;
}

std::vector<dvec3> clumped(const Part& lashes, const std::vector<Lash>& ofVertex) {
    std::vector<dvec3> places = lashes.positions;
    auto clump = [](const Lash& l) { return (l.upper ? 0 : 1000) + static_cast<int>(0.24 * l.number + 0.35 * std::sin(1.7 * l.number)); };
    for (size_t v = 0; v < places.size(); ++v) {
        dvec3 sum(0);
        int count = 0;
        for (size_t w = 0; w < places.size(); ++w)
            if (clump(ofVertex[w]) == clump(ofVertex[v]) && ofVertex[w].along == ofVertex[v].along) {
                sum += lashes.positions[w];
                ++count;
            }
        places[v] += (sum / static_cast<double>(count) - places[v]) * (0.85 * smoothstep(0.0, 0.8, ofVertex[v].along));
    }
    return places;
}

Part makeLashDrops(const Eye& eye, const Part& lashes, const std::vector<Lash>& ofVertex, std::vector<dvec3>& full,
                   std::vector<Lash>& ofDrop) {
    Part part;
    part.name = eye.side > 0 ? "lashDropsLeft" : "lashDropsRight";
    part.material = "drop";
    const std::vector<dvec3> wet = clumped(lashes, ofVertex);
    constexpr uint32_t kAround = 10, kRows = 7;
    for (size_t v = 0; v < wet.size(); ++v) {
        const Lash& l = ofVertex[v];
        const bool holds = l.upper ? l.number % 23 == 12 : l.number % 9 == 4;
        if (!holds || std::abs(l.along - (l.upper ? 0.6 : 0.8)) > 1e-6 || lashes.uvs[v].x > 0) continue;
        const double radius = l.upper ? 0.030 : 0.038 + 0.010 * (l.number % 3);
        const auto first = static_cast<uint32_t>(part.positions.size());
        for (uint32_t j = 0; j <= kRows; ++j)
            for (uint32_t i = 0; i < kAround; ++i) {
                const double a = 2 * kPi * i / kAround, b = kPi * j / kRows;
                const dvec3 d(std::sin(b) * std::cos(a), std::cos(b), std::sin(b) * std::sin(a));
                part.positions.push_back(lashes.positions[v] + 0.003 * d);
                full.push_back(wet[v] + radius * d * dvec3(1, d.y > 0 ? 1.35 : 1.0, 1));  // drawn out along the hairs that hold it
                part.uvs.emplace_back(static_cast<double>(i) / kAround, static_cast<double>(j) / kRows);
                ofDrop.push_back(l);
            }
        for (uint32_t j = 0; j < kRows; ++j)
            for (uint32_t i = 0; i < kAround; ++i) {
                const uint32_t p = first + j * kAround + i, q = first + j * kAround + (i + 1) % kAround;
                if (j > 0) part.triangles.push_back({p, q, p + kAround});
                if (j + 1 < kRows) part.triangles.push_back({q, q + kAround, p + kAround});
            }
    }
    part.normals = normalsOf(part.positions, part.triangles);
    return part;
}

}  // namespace rivulet::head
