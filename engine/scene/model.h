// Model: the contents of a model file: parts with materials, nodes, morph targets, bones, animation clips, cameras and lights.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "engine/material/material.h"
#include "engine/scene/mesh.h"

namespace rivulet {

// A morph target: offsets of vertices at weight 1. Vertices that do not move are not listed.
struct MorphTarget {
    std::string name;
    std::vector<uint32_t> vertices;  // ascending
    std::vector<vec3> offsets;       // m, one for each of `vertices`
};

struct Bone {
    int node = 0;         // index of the model's node that moves the bone
    mat4 fromMesh{1.0F};  // mesh -> bone, in the bind pose
};

// Skinning weights of a vertex: up to four bones; the weights sum to 1.
struct Grip {
    uvec4 bone{0};  // indices into ModelPart::bones
    vec4 weight{0.0F};
};

struct ModelNode {
    std::string name;
    mat4 local{1.0F};  // this node -> its parent
    int parent = -1;   // an earlier node, or -1
};

struct ModelPart {
    std::string name;
    Mesh mesh;  // in its node's frame
    Material material;
    std::string materialName;  // as the file calls it
    bool hasMaterial = false;  // the material is from the file; else it is the default material
    int node = 0;
    std::vector<MorphTarget> morphs;
    std::vector<float>
        restWeights;  // weights of `morphs` in the file, already applied to `mesh`; used while no clip sets others. Empty: all 0
    std::vector<Bone> bones;
    std::vector<Grip> grips;  // empty, or one per vertex
};

// Values at times (s, ascending): interpolated linearly between two, constant before the first and after the last.
template <class T>
struct Keys {
    std::vector<double> times;
    std::vector<T> values;  // one per time
};

// The animation of a node relative to its parent: scale, then rotation, then translation. A component without keys keeps the node's value.
struct NodeTrack {
    int node = 0;
    Keys<vec3> position;  // in the unit of the file
    Keys<quat> rotation;  // unit
    Keys<vec3> scale;
};

// The weights of the morphs of all parts on a node.
struct MorphTrack {
    int node = 0;
    Keys<std::vector<float>> weights;
};

struct Clip {
    std::string name;
    double seconds = 0;
    std::vector<NodeTrack> nodes;
    std::vector<MorphTrack> morphs;
};

// A camera that looks along `direction`; in its node's frame.
struct ModelCamera {
    std::string name;
    int node = 0;
    vec3 position{0.0F}, direction{0.0F, 0.0F, -1.0F};
    float fieldOfView = 40.0F;  // deg, vertical
};

// A directional light that shines along `direction`, in its node's frame.
struct ModelLight {
    std::string name;
    int node = 0;
    vec3 direction{0.0F, 0.0F, -1.0F};
    vec3 colour{1.0F};  // linear, with its intensity
};

struct Model {
    std::vector<ModelNode> nodes;
    std::vector<ModelPart> parts;
    std::vector<Clip> clips;
    std::vector<ModelCamera> cameras;
    std::vector<ModelLight> lights;

    std::vector<mat4> worldMatrices() const;  // each node's, in the order of `nodes`
    // The same with other local matrices: one per node, node -> its parent.
    std::vector<mat4> worldMatrices(const std::vector<mat4>& locals) const;
    ModelPart* find(std::string_view partName);  // null: no part has that name
    // The skinning matrices of a part, one per bone, for nodes with the world matrices `world`.
    std::vector<mat4> boneMatrices(const ModelPart& part, const std::vector<mat4>& world) const;
};

}  // namespace rivulet
