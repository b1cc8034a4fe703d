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
    int node = 0;
    std::vector<MorphTarget> morphs;
    std::vector<Bone> bones;
    std::vector<Grip> grips;  // empty, or one a vertex
};

struct Model {
    std::vector<ModelNode> nodes;
    std::vector<ModelPart> parts;

    std::vector<mat4> worldMatrices() const;     // each node's, in the order of `nodes`
    ModelPart* find(std::string_view partName);  // null: there is none of that name
    // What turns a part's vertices, a matrix a bone, when the nodes stand where `world` says.
    std::vector<mat4> boneMatrices(const ModelPart& part, const std::vector<mat4>& world) const;
};

}  // namespace rivulet
