#include "engine/scene/model_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rivulet {
namespace {

constexpr int kWidestImage = 16384;      // texels, as in load_image.h
constexpr size_t kMostMorphs = 4096;     // weights in a key, as in import/read_motion.cpp
constexpr float kUnitTolerance = 1e-3F;  // of the length of rotations
constexpr float kMostDegrees = 360.0F;   // of a camera's view
constexpr const char* kNumber = "that is not finite or is above 1e15";

bool isSane(float x) { return std::abs(x) <= kFarthest; }  // false for NaN
bool isSane(double x) { return std::abs(x) <= double{kFarthest}; }
bool isSane(const vec2& v) { return isSane(v.x) && isSane(v.y); }
bool isSane(const vec3& v) { return isSane(v.x) && isSane(v.y) && isSane(v.z); }
bool isSane(const vec4& v) { return isSane(v.x) && isSane(v.y) && isSane(v.z) && isSane(v.w); }
bool isSane(const mat4& m) { return isSane(m[0]) && isSane(m[1]) && isSane(m[2]) && isSane(m[3]); }
bool isSane(const std::vector<float>& all) {
    return !all.empty() && all.size() <= kMostMorphs && std::ranges::all_of(all, [](float x) { return isSane(x); });
}
bool isSane(const quat& q) { return std::abs(glm::length(q) - 1.0F) <= kUnitTolerance; }

template <class T>
bool areSane(const std::vector<T>& all) {
    return std::ranges::all_of(all, [](const T& x) { return isSane(x); });
}

template <class T>
bool isEmptyOr(size_t count, const std::vector<T>& all) {
    return all.empty() || all.size() == count;
}

bool isImage(const std::shared_ptr<const Image>& image) {
    if (!image) return true;
    const auto side = [](int texels) { return texels >= 1 && texels <= kWidestImage; };
    return side(image->width) && side(image->height) &&
           image->rgba.size() == 4 * static_cast<size_t>(image->width) * static_cast<size_t>(image->height);
}

std::string faultOf(const Mesh& mesh) {
    const size_t count = mesh.positions.size();
    if (!areSane(mesh.positions)) return fmt::format("has a vertex with a coordinate {}", kNumber);
    if (!isEmptyOr(count, mesh.normals) || !areSane(mesh.normals)) return "has a normal that is not finite, or too few normals";
    if (!isEmptyOr(count, mesh.uvs) || !areSane(mesh.uvs)) return fmt::format("has a texture coordinate {}, or too few of them", kNumber);
    if (mesh.indices.empty() || mesh.indices.size() % 3 != 0) return "has no triangles";
    if (!std::ranges::all_of(mesh.indices, [count](uint32_t k) { return k < count; })) return "has a triangle whose index is out of range";
    return {};
}

std::string faultOf(const Material& m) {
    if (!isSane(m.baseColour) || !isSane(m.emission) || !isSane(m.roughness) || !isSane(m.metallic) || !isSane(m.opacity) ||
        !isSane(m.cutoff))
        return fmt::format("has a material with a number {}", kNumber);
    for (const auto* image : {&m.colour, &m.metallicRoughness, &m.normals, &m.occlusion, &m.glow})
        if (!isImage(*image)) return "has a texture whose texels do not match its size";
    return {};
}

std::string faultOf(const MorphTarget& morph, size_t vertices) {
    const bool ascend = std::ranges::adjacent_find(morph.vertices, std::greater_equal<>()) == morph.vertices.end();
    if (!ascend || (!morph.vertices.empty() && morph.vertices.back() >= vertices) || morph.offsets.size() != morph.vertices.size())
        return "has a morph target with a vertex index out of range";
    return areSane(morph.offsets) ? std::string() : fmt::format("has a morph target with an offset {}", kNumber);
}

std::string faultOf(const ModelPart& part, size_t nodes) {
    if (part.node < 0 || static_cast<size_t>(part.node) >= nodes) return "has a part without a node";
    if (std::string fault = faultOf(part.mesh); !fault.empty()) return fault;
    if (std::string fault = faultOf(part.material); !fault.empty()) return fault;
    for (const MorphTarget& morph : part.morphs)
        if (std::string fault = faultOf(morph, part.mesh.positions.size()); !fault.empty()) return fault;
    if (!isEmptyOr(part.morphs.size(), part.restWeights) || !areSane(part.restWeights))
        return fmt::format("has a morph weight {}", kNumber);
    for (const Bone& bone : part.bones) {
        if (bone.node < 0 || static_cast<size_t>(bone.node) >= nodes) return "has a bone without a node";
        if (!isSane(bone.fromMesh)) return fmt::format("has a bone with a matrix {}", kNumber);
    }
    if (!isEmptyOr(part.mesh.positions.size(), part.grips)) return "has too few bone weights";
    const auto held = [bones = part.bones.size()](const Grip& grip) {
        const uvec4& b = grip.bone;
        return isSane(grip.weight) && b.x < bones && b.y < bones && b.z < bones && b.w < bones;
    };
    return std::ranges::all_of(part.grips, held) ? std::string() : "has a bone index out of range";
}

template <class T>
bool areKeys(const Keys<T>& keys) {
    const bool ascend = std::ranges::adjacent_find(keys.times, std::greater_equal<>()) == keys.times.end();
    return keys.times.size() == keys.values.size() && areSane(keys.times) && ascend && areSane(keys.values);
}

std::string faultOf(const Clip& clip, size_t nodes) {
    const auto wrong = [nodes](int node) { return node < 0 || static_cast<size_t>(node) >= nodes; };
    if (!isSane(clip.seconds) || clip.seconds < 0) return fmt::format("has an animation with a length {}", kNumber);
    for (const NodeTrack& track : clip.nodes) {
        if (wrong(track.node)) return "has an animation of a node that does not exist";
        if (!areKeys(track.position) || !areKeys(track.rotation) || !areKeys(track.scale))
            return "has an animation with a time or a value out of range";
    }
    for (const MorphTrack& track : clip.morphs) {
        if (wrong(track.node)) return "has an animation of a node that does not exist";
        if (!areKeys(track.weights)) return "has an animation with a morph weight out of range";
    }
    return {};
}

}  // namespace

std::string faultOf(const Model& model) {
    const size_t nodes = model.nodes.size();
    const auto wrong = [nodes](int node) { return node < 0 || static_cast<size_t>(node) >= nodes; };
    for (size_t k = 0; k < nodes; ++k) {
        const int parent = model.nodes[k].parent;
        if (parent < -1 || parent >= static_cast<int>(k)) return "has a node whose parent does not come before it";
        if (!isSane(model.nodes[k].local)) return fmt::format("has a node with a matrix {}", kNumber);
    }
    if (model.parts.empty()) return "has no triangles";
    for (const ModelPart& part : model.parts)
        if (std::string fault = faultOf(part, nodes); !fault.empty()) return fault;
    for (const Clip& clip : model.clips)
        if (std::string fault = faultOf(clip, nodes); !fault.empty()) return fault;
    for (const ModelCamera& camera : model.cameras)
        if (wrong(camera.node) || !isSane(camera.position) || !isSane(camera.direction) || camera.direction == vec3(0.0F) ||
            !(camera.fieldOfView > 0) || camera.fieldOfView > kMostDegrees)
            return "has a camera without a node, or with a number out of range";
    for (const ModelLight& light : model.lights)
        if (wrong(light.node) || !isSane(light.direction) || light.direction == vec3(0.0F) || !isSane(light.colour))
            return "has a light without a node, or with a number out of range";
    return {};
}

}  // namespace rivulet
