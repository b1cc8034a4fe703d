#include "fluid/scene/eye_motion.h"

#include <algorithm>
#include <cmath>

namespace rivulet {
namespace {

std::vector<vec3> movedBy(const Mesh& mesh, const MorphTarget& morph) {
    std::vector<vec3> moved = mesh.positions;
    for (size_t k = 0; k < morph.vertices.size(); ++k) moved[morph.vertices[k]] += morph.offsets[k];
    return moved;
}

// Of two directions: an orthonormal frame.
mat3 frameOf(const vec3& a, const vec3& b) {
    const vec3 x = glm::normalize(a), z = glm::normalize(glm::cross(a, b));
    return {x, glm::cross(z, x), z};
}

// The rotation about `centre` that takes `rest` to `moved`.
std::optional<vec3> rotationOf(const std::vector<vec3>& rest, const std::vector<vec3>& moved, const vec3& centre) {
    if (rest.size() < 3) return {};
    const vec3 a = rest[0] - centre;
    size_t second = 0;
    float widest = 0, radius = 0;
    for (size_t k = 0; k < rest.size(); ++k) {
        const vec3 x = rest[k] - centre;
        radius = std::max(radius, glm::length(x));
        if (const float wide = glm::length(glm::cross(a, x)); wide > widest) {
            widest = wide;
            second = k;
        }
    }
    if (widest < 1.0e-3F * radius * radius) return {};
    const mat3 turn = frameOf(moved[0] - centre, moved[second] - centre) * glm::transpose(frameOf(a, rest[second] - centre));
    float furthest = 0;
    for (size_t k = 0; k < rest.size(); ++k) furthest = std::max(furthest, glm::distance(rest[k], moved[k]));
    const float most =
        std::min(0.02F * radius, std::max(0.1F * furthest, 1.0e-5F * radius));  // a small motion of a large part is no rotation
    for (size_t k = 0; k < rest.size(); ++k)
        if (!(glm::distance(centre + turn * (rest[k] - centre), moved[k]) <= most)) return {};
    const quat q = glm::quat_cast(turn);
    return glm::axis(q) * std::remainder(glm::angle(q), 2 * kPi);
}

}  // namespace

mat4 EyeTurns::at(const vec3& turn) const {
    const float angle = glm::length(turn);
    if (angle < 1.0e-6F) return mat4(1.0F);
    return glm::translate(mat4(1.0F), centre) * glm::rotate(mat4(1.0F), angle, turn / angle) * glm::translate(mat4(1.0F), -centre);
}

std::optional<EyeTurns> takeEyeTurns(ModelPart& part, std::span<const vec3> centres) {
    if (part.morphs.empty() || !part.grips.empty()) return {};
    for (const vec3& centre : centres) {
        EyeTurns eye{centre, {}};
        for (const MorphTarget& morph : part.morphs)
            if (const std::optional<vec3> turn = rotationOf(part.mesh.positions, movedBy(part.mesh, morph), centre))
                eye.turns[morph.name] = *turn;
        if (eye.turns.size() < part.morphs.size()) continue;
        part.morphs.clear();
        part.restWeights.clear();
        return eye;
    }
    return {};
}

std::vector<float> sharesOfBlink(const std::vector<MorphTarget>& morphs, size_t blink) {
    std::vector<float> shares(morphs.size(), 0.0F);
    const MorphTarget& way = morphs[blink];
    size_t furthest = 0;
    for (size_t k = 0; k < way.offsets.size(); ++k)
        if (glm::length(way.offsets[k]) > glm::length(way.offsets[furthest])) furthest = k;
    if (way.offsets.empty() || !(glm::length(way.offsets[furthest]) > 0)) return shares;
    const vec3 whole = way.offsets[furthest];
    for (size_t m = 0; m < morphs.size(); ++m) {
        const auto& at = morphs[m].vertices;
        const auto found = std::find(at.begin(), at.end(), way.vertices[furthest]);
        if (found != at.end())
            shares[m] = glm::dot(morphs[m].offsets[static_cast<size_t>(found - at.begin())], whole) / glm::dot(whole, whole);
    }
    return shares;
}

}  // namespace rivulet
