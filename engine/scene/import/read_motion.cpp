#include "engine/scene/import/read_motion.h"

#include <algorithm>
#include <cmath>

namespace rivulet {

mat4 matrixOf(const aiMatrix4x4& m) {
    return {m.a1, m.b1, m.c1, m.d1, m.a2, m.b2, m.c2, m.d2, m.a3, m.b3, m.c3, m.d3, m.a4, m.b4, m.c4, m.d4};
}
vec3 vectorOf(const aiVector3D& v) { return {v.x, v.y, v.z}; }

namespace {

constexpr double kTicksPerSecond = 25;  // if the file does not state it

template <class T>
void addKey(Keys<T>& keys, double time, bool finite, T value) {
    if (!finite || !std::isfinite(time) || (!keys.times.empty() && !(time > keys.times.back()))) return;
    keys.times.push_back(time);
    keys.values.push_back(std::move(value));
}

NodeTrack trackOf(const aiNodeAnim& from, int node, double ticks) {
    NodeTrack to{.node = node, .position = {}, .rotation = {}, .scale = {}};
    for (unsigned k = 0; k < from.mNumPositionKeys; ++k) {
        const vec3 p = vectorOf(from.mPositionKeys[k].mValue);
        addKey(to.position, from.mPositionKeys[k].mTime / ticks, isFinite(p), p);
    }
    for (unsigned k = 0; k < from.mNumRotationKeys; ++k) {
        const aiQuaternion& r = from.mRotationKeys[k].mValue;
        const quat q(r.w, r.x, r.y, r.z);
        const float length = glm::length(q);
        addKey(to.rotation, from.mRotationKeys[k].mTime / ticks, std::isfinite(length) && length > 0, q / length);
    }
    for (unsigned k = 0; k < from.mNumScalingKeys; ++k) {
        const vec3 s = vectorOf(from.mScalingKeys[k].mValue);
        addKey(to.scale, from.mScalingKeys[k].mTime / ticks, isFinite(s), s);
    }
    return to;
}

MorphTrack trackOf(const aiMeshMorphAnim& from, int node, double ticks) {
    MorphTrack to{.node = node, .weights = {}};
    for (unsigned k = 0; k < from.mNumKeys; ++k) {
        const aiMeshMorphKey& key = from.mKeys[k];
        std::vector<float> weights;
        bool sound = key.mNumValuesAndWeights > 0;
        for (unsigned m = 0; m < key.mNumValuesAndWeights; ++m) {
            const size_t morph = key.mValues[m];
            if (morph >= 4096) {  // larger indices are invalid: no mesh has as many morphs
                sound = false;
                break;
            }
            weights.resize(std::max(weights.size(), morph + 1), 0.0F);
            weights[morph] = static_cast<float>(key.mWeights[m]);
            sound = sound && std::isfinite(weights[morph]);
        }
        addKey(to.weights, key.mTime / ticks, sound, std::move(weights));
    }
    return to;
}

Clip clipOf(const aiAnimation& from, const std::map<std::string, int>& nodeOf) {
    Clip clip;
    clip.name = from.mName.C_Str();
    const double ticks = from.mTicksPerSecond > 0 ? from.mTicksPerSecond : kTicksPerSecond;
    const auto last = [&clip](const auto& keys) {
        if (!keys.times.empty()) clip.seconds = std::max(clip.seconds, keys.times.back());
    };
    for (unsigned c = 0; c < from.mNumChannels; ++c) {
        const auto node = nodeOf.find(from.mChannels[c]->mNodeName.C_Str());
        if (node == nodeOf.end()) continue;
        clip.nodes.push_back(trackOf(*from.mChannels[c], node->second, ticks));
        last(clip.nodes.back().position);
        last(clip.nodes.back().rotation);
        last(clip.nodes.back().scale);
    }
    for (unsigned c = 0; c < from.mNumMorphMeshChannels; ++c) {
        const auto node = nodeOf.find(from.mMorphMeshChannels[c]->mName.C_Str());
        if (node == nodeOf.end()) continue;
        MorphTrack track = trackOf(*from.mMorphMeshChannels[c], node->second, ticks);
        if (track.weights.times.empty()) continue;
        last(track.weights);
        clip.morphs.push_back(std::move(track));
    }
    return clip;
}

// assimp 5.2 returns the vertical angle times the aspect ratio for glTF, and the horizontal angle for other files.
float verticalView(const aiCamera& from, bool gltf) {
    const float aspect = from.mAspect > 0 ? from.mAspect : 1.0F;
    const float angle = gltf ? from.mHorizontalFOV / aspect : 2.0F * std::atan(std::tan(0.5F * from.mHorizontalFOV) / aspect);
    return std::isfinite(angle) && angle > 0 ? angle / kDegree : ModelCamera().fieldOfView;
}

}  // namespace

void readMotion(const aiScene& scene, const std::map<std::string, int>& nodeOf, bool gltf, Model& model) {
    for (unsigned a = 0; a < scene.mNumAnimations; ++a) {
        Clip clip = clipOf(*scene.mAnimations[a], nodeOf);
        if (!clip.nodes.empty() || !clip.morphs.empty()) model.clips.push_back(std::move(clip));
    }
    for (unsigned c = 0; c < scene.mNumCameras; ++c) {
        const aiCamera& from = *scene.mCameras[c];
        const auto node = nodeOf.find(from.mName.C_Str());
        // For glTF, assimp repeats the node's transform in the camera; a glTF camera is at its node.
        const vec3 position = gltf ? vec3(0.0F) : vectorOf(from.mPosition), direction = vectorOf(from.mLookAt);
        if (node == nodeOf.end() || !isFinite(position) || !isFinite(direction) || direction == vec3(0.0F)) continue;
        model.cameras.push_back({from.mName.C_Str(), node->second, position, direction, verticalView(from, gltf)});
    }
    for (unsigned l = 0; l < scene.mNumLights; ++l) {
        const aiLight& from = *scene.mLights[l];
        const auto node = nodeOf.find(from.mName.C_Str());
        const vec3 direction = vectorOf(from.mDirection), colour(from.mColorDiffuse.r, from.mColorDiffuse.g, from.mColorDiffuse.b);
        if (from.mType != aiLightSource_DIRECTIONAL || node == nodeOf.end() || !isFinite(direction) || direction == vec3(0.0F)) continue;
        if (isFinite(colour)) model.lights.push_back({from.mName.C_Str(), node->second, direction, glm::max(colour, vec3(0.0F))});
    }
}

}  // namespace rivulet
