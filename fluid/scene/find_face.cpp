#include "fluid/scene/find_face.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <unordered_map>

#include "fluid/flow/flow_mesh.h"
#include "fluid/scene/ball_fit.h"
#include "fluid/scene/depth_map.h"
#include "fluid/scene/face_features.h"

namespace rivulet {

namespace {

// Proportions of adult faces, which the three heads at hand share within a few percent: the outer corners of the eyes are this many times
// as far apart as the inner ones, and a lower lid hangs by this share of its length.
constexpr float kOuterToInner = 2.43F, kSag = 0.12F;

struct PlaceHash {
    size_t operator()(const vec3& p) const {
        size_t h = 0;
        for (int k = 0; k < 3; ++k) h = h * 1000003U + std::hash<float>()(p[k]);
        return h;
    }
};

// The pieces of a mesh: triangles that are connected by places. Of each triangle the number of its piece.
std::vector<uint32_t> piecesOf(const Mesh& mesh, uint32_t& count) {
    std::unordered_map<vec3, uint32_t, PlaceHash> known;
    std::vector<uint32_t> place(mesh.positions.size());
    for (size_t i = 0; i < place.size(); ++i)
        place[i] = known.try_emplace(mesh.positions[i] + 0.0F, static_cast<uint32_t>(known.size())).first->second;
    std::vector<uint32_t> root(known.size());
    std::iota(root.begin(), root.end(), 0U);
    const auto find = [&root](uint32_t v) {
        while (root[v] != v) v = root[v] = root[root[v]];
        return v;
    };
    for (size_t t = 0; t + 2 < mesh.indices.size(); t += 3)
        for (size_t k = 1; k < 3; ++k) root[find(place[mesh.indices[t + k]])] = find(place[mesh.indices[t]]);
    std::vector<uint32_t> number(root.size(), UINT32_MAX), piece;
    count = 0;
    for (size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
        uint32_t& n = number[find(place[mesh.indices[t]])];
        if (n == UINT32_MAX) n = count++;
        piece.push_back(n);
    }
    return piece;
}

bool mentions(const ModelPart& part, std::initializer_list<const char*> words) {
    for (std::string text : {part.name, part.materialName}) {
        std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
        for (const char* word : words)
            if (text.find(word) != std::string::npos) return true;
    }
    return false;
}

// A piece that is round.
struct Ball {
    vec3 centre{0.0F};
    float radius = 0;
    size_t part = 0;
    uint32_t piece = 0;
    bool named = false;  // its name speaks of an eye
};

double areaOf(const vec3& a, const vec3& b, const vec3& c) { return 0.5 * glm::length(glm::cross(dvec3(b - a), dvec3(c - a))); }

// Most of its area is near one sphere, of which it covers half; of a piece that is called an eye, a cap is enough.
bool isBall(const Mesh& mesh, const std::vector<uint32_t>& triangles, Ball& ball) {
    constexpr size_t kLeast = 40;  // triangles; a box is no ball
    if (triangles.size() < kLeast) return false;
    std::vector<vec3> points;
    Bounds box;
    for (const uint32_t t : triangles)
        for (size_t k = 0; k < 3; ++k) {
            points.push_back(mesh.positions[mesh.indices[3 * size_t{t} + k]]);
            box.add(points.back());
        }
    const vec3 size = box.size();
    const float longest = std::max({size.x, size.y, size.z}), shortest = std::min({size.x, size.y, size.z});
    if (!(longest > 0)) return false;
    std::vector<vec3> scaled = points;
    for (vec3& p : scaled) p = (p - box.centre()) / longest;
    if (!fitBall(scaled, ball.centre, ball.radius)) return false;
    const float r = ball.radius * longest;
    if (longest > 2.6F * r || shortest < (ball.named ? 0.35F : 0.85F) * r) return false;
    double near = 0, all = 0;
    for (size_t k = 0; k < scaled.size(); k += 3) {
        const double area = areaOf(scaled[k], scaled[k + 1], scaled[k + 2]);
        const vec3 middle = (scaled[k] + scaled[k + 1] + scaled[k + 2]) / 3.0F;
        all += area;
        if (std::abs(glm::distance(middle, ball.centre) - ball.radius) < 0.08F * ball.radius) near += area;
    }
    if (near < 0.6 * all) return false;
    ball.centre = box.centre() + longest * ball.centre;
    ball.radius = r;
    return true;
}

struct Pieces {
    std::vector<uint32_t> of;  // each triangle
    std::vector<std::vector<uint32_t>> triangles;
    explicit Pieces(const Mesh& mesh) {
        uint32_t count = 0;
        of = piecesOf(mesh, count);
        triangles.resize(count);
        for (uint32_t t = 0; t < of.size(); ++t) triangles[of[t]].push_back(t);
    }
};

std::vector<Ball> ballsOf(std::span<const ModelPart> parts, size_t skin, const Pieces& ofSkin) {
    std::vector<Ball> balls;
    for (size_t p = 0; p < parts.size(); ++p) {
        const Pieces own = p == skin ? ofSkin : Pieces(parts[p].mesh);
        size_t largest = 0;
        for (size_t k = 0; k < own.triangles.size(); ++k)
            if (own.triangles[k].size() > own.triangles[largest].size()) largest = k;
        const bool named =
            mentions(parts[p], {"eye", "sclera"}) && !mentions(parts[p], {"lash", "brow", "lid", "cornea", "blend", "occlusion"});
        for (uint32_t k = 0; k < own.triangles.size(); ++k) {
            if (p == skin && k == largest && own.triangles.size() > 1) continue;
            if (p == skin && own.triangles.size() == 1) continue;
            Ball ball{.part = p, .piece = k, .named = named};
            if (isBall(parts[p].mesh, own.triangles[k], ball)) balls.push_back(ball);
        }
    }
    return balls;
}

// Two balls of one size, apart as eyes are. Those of an outer shell before those within: the largest first.
std::vector<std::pair<Ball, Ball>> pairsOf(std::vector<Ball> balls) {
    std::sort(balls.begin(), balls.end(), [](const Ball& a, const Ball& b) { return a.radius > b.radius; });
    if (balls.size() > 64) balls.resize(64);
    std::vector<std::pair<Ball, Ball>> pairs;
    for (size_t i = 0; i < balls.size(); ++i)
        for (size_t k = i + 1; k < balls.size(); ++k) {
            const float apart = glm::distance(balls[i].centre, balls[k].centre) / balls[i].radius;
            if (balls[k].radius > 0.8F * balls[i].radius && apart > 2 && apart < 9) pairs.emplace_back(balls[i], balls[k]);
        }
    std::stable_sort(pairs.begin(), pairs.end(), [](const auto& a, const auto& b) { return a.first.named > b.first.named; });
    if (pairs.size() > 8) pairs.resize(8);
    return pairs;
}

std::vector<vec3> axesAcross(const vec3& side) {
    std::vector<vec3> axes;
    for (const vec3& a : {vec3(0, 0, 1), vec3(0, 1, 0), vec3(1, 0, 0), vec3(0, 0, -1), vec3(0, -1, 0), vec3(-1, 0, 0)})
        if (std::abs(glm::dot(a, side)) < 0.3F) axes.push_back(glm::normalize(a - side * glm::dot(a, side)));
    return axes;
}

struct EyePair {
    vec3 centre[2];
    float radius[2];
    bool balls = true;
};

// Tries the directions in which a face with these eyes may look, and takes the one with two openings and the most of a nose.
bool tryPair(const EyePair& pair, const std::vector<vec3>& skin, const std::vector<vec3>& directions, FoundFace& best, float& bestScore) {
    const float d = glm::distance(pair.centre[0], pair.centre[1]);
    const vec3 across = (pair.centre[1] - pair.centre[0]) / d;
    bool any = false;
    for (const vec3& forward : directions)
        for (const float turn : {1.0F, -1.0F}) {
            const vec3 x = turn * across, up = glm::cross(forward, x);
            const size_t left = turn > 0 ? 1 : 0;
            FoundFace face;
            face.up = up;
            face.forward = forward;
            bool open = true;
            for (size_t side = 0; side < 2 && open; ++side) {
                const size_t at = side == 0 ? left : 1 - left;
                // A right eye is seen in a mirror, so that x points away from the nose.
                const ViewFrame frame{pair.centre[at], side == 0 ? x : -x, up, forward};
                const std::optional<Opening> o = openingAt(frame, skin, pair.radius[at], pair.balls, d);
                open = o.has_value();
                if (!open) break;
                face.eyes[side] = {o->inner, o->outer, o->tear, o->lower, pair.centre[at], pair.balls ? pair.radius[at] : 0.0F};
            }
            if (!open) continue;
            const ViewFrame frame{0.5F * (pair.centre[0] + pair.centre[1]), x, up, forward};
            const float cornerZ = 0.5F * (frame.into(face.eyes[0].inner).z + frame.into(face.eyes[1].inner).z);
            const NoseAndChin nose = noseAndChin(frame, skin, d, cornerZ);
            if (nose.nose) face.nose = frame.back(*nose.nose);
            if (nose.chin) face.chin = frame.back(*nose.chin);
            // Of two that are as good, such as of a face without a nose, the one that stands as scenes do.
            const float score = std::max(nose.prominence, 0.0F) + 0.01F * up.y + 0.005F * forward.z;
            if (score <= bestScore) continue;
            any = true;
            bestScore = score;
            face.by = pair.balls ? FoundFace::By::balls : FoundFace::By::holes;
            best = face;
        }
    return any;
}

// The mean direction from the balls to the skin about them: lids lie in front.
std::optional<vec3> towardsLids(const EyePair& pair, const std::vector<vec3>& skin) {
    dvec3 sum(0.0);
    double all = 0;
    for (size_t t = 0; t + 2 < skin.size(); t += 3) {
        const vec3 middle = (skin[t] + skin[t + 1] + skin[t + 2]) / 3.0F;
        for (size_t side = 0; side < 2; ++side) {
            const vec3 x = middle - pair.centre[side];
            const float off = glm::length(x) / pair.radius[side];
            if (off < 0.9F || off > 1.6F) continue;
            const double area = areaOf(skin[t], skin[t + 1], skin[t + 2]);
            sum += area * dvec3(glm::normalize(x));
            all += area;
        }
    }
    const vec3 across = glm::normalize(pair.centre[1] - pair.centre[0]);
    if (!(all > 0)) return std::nullopt;
    vec3 way = vec3(sum / all);
    way -= across * glm::dot(way, across);
    if (glm::length(way) < 0.1F) return std::nullopt;
    return glm::normalize(way);
}

// The edge of a hole in the skin.
struct Hole {
    std::vector<vec3> points;
    vec3 middle{0.0F}, normal{0.0F};
    float length = 0;
};

std::vector<Hole> holesOf(const FlowMesh& mesh) {
    std::map<uint32_t, std::vector<std::pair<uint32_t, uint32_t>>> next;  // place -> its next place and the triangle beside the edge
    for (uint32_t t = 0; t < mesh.triangleCount(); ++t)
        for (uint32_t k = 0; k < 3; ++k)
            if (mesh.across[3 * size_t{t} + k] == FlowMesh::kOpen)
                next[mesh.corner[3 * size_t{t} + k]].emplace_back(mesh.corner[3 * size_t{t} + (k + 1) % 3], t);
    std::vector<Hole> holes;
    while (!next.empty()) {
        Hole hole;
        dvec3 normal(0.0);
        for (uint32_t at = next.begin()->first;;) {
            const auto edges = next.find(at);
            if (edges == next.end()) break;
            const auto [to, triangle] = edges->second.back();
            edges->second.pop_back();
            if (edges->second.empty()) next.erase(edges);
            hole.points.push_back(mesh.rest[at]);
            normal += restNormal(mesh, triangle);
            hole.length += glm::distance(mesh.rest[at], mesh.rest[to]);
            at = to;
        }
        if (hole.points.size() < 6) continue;
        for (const vec3& p : hole.points) hole.middle += p / static_cast<float>(hole.points.size());
        hole.normal = vec3(normal);
        holes.push_back(std::move(hole));
    }
    std::sort(holes.begin(), holes.end(), [](const Hole& a, const Hole& b) { return a.length > b.length; });
    if (holes.size() > 40) holes.resize(40);
    return holes;
}

// Extent of a hole along a direction.
float extentOf(const Hole& hole, const vec3& way) {
    float low = 1.0e30F, high = -1.0e30F;
    for (const vec3& p : hole.points) {
        low = std::min(low, glm::dot(p, way));
        high = std::max(high, glm::dot(p, way));
    }
    return high - low;
}

bool byHoles(const FlowMesh& mesh, const std::vector<vec3>& skin, FoundFace& face) {
    const std::vector<Hole> holes = holesOf(mesh);
    for (size_t i = 0; i < holes.size(); ++i)
        for (size_t k = i + 1; k < holes.size(); ++k) {
            if (holes[k].length < 0.85F * holes[i].length) break;
            const vec3 between = holes[k].middle - holes[i].middle;
            const float d = glm::length(between);
            if (!(d > 0)) continue;
            const vec3 across = between / d;
            const float wide = 0.5F * (extentOf(holes[i], across) + extentOf(holes[k], across));
            if (!(wide > 0) || d / wide < 1.5F || d / wide > 3.6F) continue;  // eyes: about 2.4
            std::vector<vec3> directions = axesAcross(across);
            const vec3 mean = holes[i].normal + holes[k].normal, flat = mean - across * glm::dot(mean, across);
            for (const vec3& forward : std::vector<vec3>(directions)) {
                // The rim is wider than high.
                const float high = extentOf(holes[i], glm::cross(forward, across));
                if (high > wide || high < 0.1F * wide) std::erase(directions, forward);
            }
            if (directions.empty() && glm::length(flat) > 0) directions.push_back(glm::normalize(flat));
            FoundFace best;
            float score = -1;
            for (const vec3& forward : directions) {
                const EyePair pair{{holes[i].middle - 0.5F * wide * forward, holes[k].middle - 0.5F * wide * forward},
                                   {0.55F * wide, 0.55F * wide},
                                   false};
                tryPair(pair, skin, {forward}, best, score);
            }
            // Without a nose between them two holes may be anything.
            if (best.found() && best.nose) {
                face = best;
                return true;
            }
        }
    return false;
}

// A skin without openings: the nose stands out before the cheeks, its root is hollow, and beside the root lie the hollows of the inner
// corners. The rest are proportions.
bool byProportions(const std::vector<vec3>& skin, FoundFace& best) {
    float bestScore = 0;
    const vec3 axes[] = {vec3(0, 0, 1), vec3(0, 1, 0), vec3(1, 0, 0), vec3(0, 0, -1), vec3(0, -1, 0), vec3(-1, 0, 0)};
    for (const vec3& forward : axes)
        for (const vec3& up : axes) {
            if (glm::dot(up, forward) != 0) continue;
            ViewFrame frame{vec3(0.0F), glm::cross(up, forward), up, forward};
            Bounds box;
            for (const vec3& p : skin) box.add(frame.into(p));
            const vec3 size = box.size();
            frame.origin = frame.back(box.centre());
            const float w = size.x;
            if (!(w > 0) || size.y < 0.6F * w || size.y > 3 * w) continue;
            constexpr int kWide = 120;
            const float step = w / kWide;
            const int tall = static_cast<int>(size.y / step);
            const DepthMap map(frame, skin, vec2(-0.5F * w, -0.5F * size.y), kWide, tall, step);
            std::vector<float> middle(static_cast<size_t>(tall), DepthMap::kNothing);
            for (int y = 0; y < tall; ++y)
                for (int x = kWide / 2 - 3; x < kWide / 2 + 3; ++x)
                    middle[static_cast<size_t>(y)] = std::max(middle[static_cast<size_t>(y)], map.at(x, y));
            const auto tip = static_cast<int>(std::max_element(middle.begin(), middle.end()) - middle.begin());
            const float tipZ = middle[static_cast<size_t>(tip)];
            float cheeks = DepthMap::kNothing;
            for (int x = kWide / 5; x <= kWide * 3 / 10; ++x)
                for (const float there : {map.at(kWide / 2 - x, tip), map.at(kWide / 2 + x, tip)}) cheeks = std::max(cheeks, there);
            if (!std::isfinite(cheeks) || tipZ - cheeks < 0.12F * w) continue;
            // The root of the nose: up from the tip, where the profile comes forward again.
            int root = -1;
            for (int y = tip; y < tall && static_cast<float>(y - tip) < 0.5F * kWide; ++y) {
                const float z = middle[static_cast<size_t>(y)];
                if (!std::isfinite(z)) break;
                if (root < 0 || z < middle[static_cast<size_t>(root)]) root = y;
                if (root > tip && z > middle[static_cast<size_t>(root)] + 0.006F * w) break;
                if (y + 1 == tall) root = -1;
            }
            if (root < 0) continue;
            const float n = static_cast<float>(root - tip) * step;  // length of the nose
            if (n < 0.12F * w || n > 0.45F * w || tipZ - middle[static_cast<size_t>(root)] < 0.08F * w) continue;
            // It slopes down from its root and overhangs the lip: without this a face upside down would pass.
            const int part = static_cast<int>(0.4F * n / step);
            if (tip < part || middle[static_cast<size_t>(tip - part)] > middle[static_cast<size_t>(tip + part)]) continue;
            const vec2 rootAt(0, map.middleOf(0, root).y);
            // The hollow beside the root, on either side.
            vec2 hollow[2] = {vec2(0.0F), vec2(0.0F)};
            float deep[2] = {0, 0};
            for (size_t side = 0; side < 2; ++side) {
                for (float x = 0.3F * n; x <= 0.75F * n; x += step)
                    for (float y = -0.45F * n; y <= 0.1F * n; y += step) {
                        const vec2 at = rootAt + vec2(side == 0 ? x : -x, y);
                        float sum = 0;
                        for (int k = 0; k < 16; ++k) {
                            const float angle = 2 * kPi * static_cast<float>(k) / 16;
                            sum += map.over(at + 0.22F * n * vec2(std::cos(angle), std::sin(angle))) / 16;
                        }
                        const float hollowness = sum - map.over(at);
                        if (!std::isfinite(hollowness) || hollowness <= deep[side]) continue;
                        deep[side] = hollowness;
                        hollow[side] = at;
                    }
            }
            if (std::min(deep[0], deep[1]) < 0.02F * n || glm::distance(hollow[0], hollow[1] * vec2(-1, 1)) > 0.2F * n) continue;
            // A chin: the front goes on below the nose.
            // The hollows are a little nearer to the nose than the corners, which are half a nose's length from its middle.
            const float inner = 0.25F * (hollow[0].x - hollow[1].x) + 0.25F * n, eyesY = 0.5F * (hollow[0].y + hollow[1].y);
            const float d = (1 + kOuterToInner) * inner;  // between the middles of the eyes
            const ViewFrame eyes{frame.back(vec3(0, eyesY, 0)), frame.x, frame.y, frame.z};
            const float innerZ = 0.5F * (map.over(hollow[0]) + map.over(hollow[1]));
            const NoseAndChin nose = noseAndChin(eyes, skin, d, innerZ);
            if (!nose.nose || !nose.chin || nose.chin->y > -1.4F * d) continue;
            const float score = nose.prominence + 0.01F * up.y;
            if (best.found() && score <= bestScore) continue;
            FoundFace face;
            face.by = FoundFace::By::proportions;
            face.up = up;
            face.forward = forward;
            face.nose = eyes.back(*nose.nose);
            face.chin = eyes.back(*nose.chin);
            bool whole = true;
            for (size_t side = 0; side < 2; ++side) {
                const float sign = side == 0 ? 1.0F : -1.0F, wide = (kOuterToInner - 1) * inner;
                const auto on = [&](const vec2& p) {
                    const float z = map.over(p);
                    whole = whole && std::isfinite(z);
                    return frame.back(vec3(p, z));
                };
                FoundEye& eye = face.eyes[side];
                for (size_t k = 0; k < kLidPoints; ++k) {
                    const float along = static_cast<float>(k) / (kLidPoints - 1);
                    eye.lowerLid.push_back(
                        on(vec2(sign * (inner + along * wide), eyesY + wide * (0.03F * along - kSag * 4 * along * (1 - along)))));
                }
                eye.inner = eye.lowerLid.front();
                eye.outer = eye.lowerLid.back();
                eye.tear = on(vec2(sign * (inner + kTearOut * d), eyesY - kTearDown * d));
            }
            if (!whole) continue;
            bestScore = score;
            best = face;
        }
    return best.found();
}

}  // namespace

float FoundFace::eyeDistance() const {
    vec3 middle[2] = {vec3(0.0F), vec3(0.0F)};
    for (size_t side = 0; side < 2; ++side) middle[side] = 0.5F * (eyes[side].inner + eyes[side].outer);
    return glm::distance(middle[0], middle[1]);
}

std::string nameOf(const ModelPart& part) {
    if (part.materialName.empty() || part.materialName == part.name) return part.name;
    return part.name.empty() ? part.materialName : part.name + " (" + part.materialName + ")";
}

FoundFace findFace(std::span<const ModelPart> parts, size_t skin) {
    const Mesh& mesh = parts[skin].mesh;
    const Pieces pieces(mesh);
    const std::vector<std::pair<Ball, Ball>> pairs = pairsOf(ballsOf(parts, skin, pieces));
    const auto skinWithout = [&](std::initializer_list<const Ball*> balls) {
        std::vector<vec3> corners;
        corners.reserve(mesh.indices.size());
        for (size_t t = 0; t < pieces.of.size(); ++t) {
            if (std::any_of(balls.begin(), balls.end(), [&](const Ball* b) { return b->part == skin && b->piece == pieces.of[t]; }))
                continue;
            for (size_t k = 0; k < 3; ++k) corners.push_back(mesh.positions[mesh.indices[3 * t + k]]);
        }
        return corners;
    };
    FoundFace face;
    for (const auto& [a, b] : pairs) {
        const std::vector<vec3> corners = skinWithout({&a, &b});
        const EyePair pair{{a.centre, b.centre}, {a.radius, b.radius}, true};
        float score = -1;
        std::vector<vec3> directions = axesAcross(glm::normalize(b.centre - a.centre));
        bool open = tryPair(pair, corners, directions, face, score);
        if (!open)
            if (const std::optional<vec3> way = towardsLids(pair, corners)) open = tryPair(pair, corners, {*way, -*way}, face, score);
        if (!open) continue;
        for (const Ball* ball : {&a, &b}) {
            const ModelPart& part = parts[ball->part];
            const std::string name = nameOf(part);
            if (std::find(face.balls.begin(), face.balls.end(), name) == face.balls.end()) face.balls.push_back(name);
        }
        return face;
    }
    const std::vector<vec3> corners = skinWithout({});
    if (const Result<FlowMesh> flow = makeFlowMesh(mesh.view()); flow && byHoles(*flow, corners, face)) return face;
    if (byProportions(corners, face)) {
        face.missing =
            "The skin has no openings for eyes: the places of the lids are those of a common face with this nose, so look at them.";
        return face;
    }
    face.missing = pairs.empty()
                       ? "No eyes were found: there are neither two eyeballs nor two holes of equal size with a nose between them, and no "
                         "face without openings is there either."
                       : "Two eyeballs were found, but no lids: the skin leaves no opening before them, or does not surround them.";
    return face;
}

}  // namespace rivulet
