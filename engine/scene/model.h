// Model: what a file holds beyond triangles: parts with materials, where they stand, morph targets, bones.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "engine/material/material.h"
#include "engine/scene/mesh.h"

namespace rivulet {

// Where vertices go as a morph's weight goes from 0 to 1. Vertices that stay are not in it.
struct MorphTarget {
    std::string name;
    std::vector<uint32_t> vertices;  // ascending
    std::vector<vec3> offsets;       // m, one a vertex of the above
};

struct Bone {
    int node = 0;         // of the model: where it is
    mat4 fromMesh{1.0F};  // the mesh -> the bone, as they were bound
};

// Up to four bones hold a vertex; weights sum to 1.
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
    bool dressed = false;      // whether the material is the file's; else it is the default one
    int node = 0;
    std::vector<MorphTarget> morphs;
    std::vector<float> resting;  // of them, as the file says where no clip does; the mesh is that already. Empty: all 0
    std::vector<Bone> bones;
    std::vector<Grip> grips;  // empty, or one a vertex
};

// Values at times (s, ascending). Between two they change evenly, before the first and after the last they stay.
template <class T>
struct Keys {
    std::vector<double> times;
    std::vector<T> values;  // as many
};

// How a node goes through a clip, in its parent's frame: scaled, then turned, then moved. What has no keys is as the node stands.
struct NodeTrack {
    int node = 0;
    Keys<vec3> position;  // the file's unit
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

// Looks along `direction`; in its node's frame.
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
    // The same of nodes that stand otherwise: one matrix each, node -> its parent.
    std::vector<mat4> worldMatrices(const std::vector<mat4>& locals) const;
    ModelPart* find(std::string_view partName);  // null: there is none of that name
    // What turns a part's vertices, a matrix a bone, when the nodes stand where `world` says.
    std::vector<mat4> boneMatrices(const ModelPart& part, const std::vector<mat4>& world) const;
};

}  // namespace rivulet
