#include "engine/scene/animation.h"

#include <algorithm>
#include <glm/ext/matrix_transform.hpp>

namespace rivulet {
namespace {

float mixed(float a, float b, float share) { return a + (b - a) * share; }
vec3 mixed(const vec3& a, const vec3& b, float share) { return glm::mix(a, b, share); }
quat mixed(const quat& a, const quat& b, float share) { return glm::normalize(glm::slerp(a, b, share)); }  // slerp takes the shorter arc
std::vector<float> mixed(const std::vector<float>& a, const std::vector<float>& b, float share) {
    std::vector<float> out(std::min(a.size(), b.size()));
    for (size_t k = 0; k < out.size(); ++k) out[k] = mixed(a[k], b[k], share);
    return out;
}

template <class T>
T at(const Keys<T>& keys, double time) {
    const auto after = static_cast<size_t>(std::upper_bound(keys.times.begin(), keys.times.end(), time) - keys.times.begin());
    if (after == 0) return keys.values.front();
    if (after == keys.times.size()) return keys.values.back();
    const double from = keys.times[after - 1], to = keys.times[after];
    return mixed(keys.values[after - 1], keys.values[after], static_cast<float>((time - from) / (to - from)));
}

// Translation, rotation and scale of a node's matrix. Shear is dropped: animated nodes have none.
struct Stand {
    vec3 position, scale;
    quat rotation;
};
Stand standOf(const mat4& m) {
    mat3 turn(m);
    vec3 scale(glm::length(turn[0]), glm::length(turn[1]), glm::length(turn[2]));
    if (glm::determinant(turn) < 0) scale.x = -scale.x;
    for (int k = 0; k < 3; ++k)
        if (scale[k] != 0) turn[k] /= scale[k];
    return {vec3(m[3]), scale, glm::normalize(glm::quat_cast(turn))};
}

}  // namespace

std::vector<mat4> nodesAt(const Model& model, const Clip& clip, double time) {
    std::vector<mat4> locals;
    locals.reserve(model.nodes.size());
    for (const ModelNode& node : model.nodes) locals.push_back(node.local);
    for (const NodeTrack& track : clip.nodes) {
        mat4& local = locals[static_cast<size_t>(track.node)];
        Stand s = standOf(local);
        if (!track.position.times.empty()) s.position = at(track.position, time);
        if (!track.rotation.times.empty()) s.rotation = at(track.rotation, time);
        if (!track.scale.times.empty()) s.scale = at(track.scale, time);
        local = glm::scale(glm::translate(mat4(1.0F), s.position) * glm::mat4_cast(s.rotation), s.scale);
    }
    return locals;
}

std::vector<float> morphsAt(const ModelPart& part, const Clip& clip, double time) {
    std::vector<float> weights;
    for (const MorphTrack& track : clip.morphs)
        if (track.node == part.node) weights = at(track.weights, time);
    if (!weights.empty()) weights.resize(part.morphs.size(), 0.0F);
    for (size_t k = 0; k < std::min(weights.size(), part.restWeights.size()); ++k) weights[k] -= part.restWeights[k];
    return weights;
}

}  // namespace rivulet
