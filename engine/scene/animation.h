// Animation: where a model's nodes are, and how its parts are bent, at a time of one of its clips.
#pragma once

#include "engine/scene/model.h"

namespace rivulet {

// Between keys all goes evenly, also where a glTF file says STEP or CUBICSPLINE: assimp 5.2 hands over neither that nor the tangents.

// Each node's matrix to its parent, in the order of model.nodes; those without a track stand as they do. `time` s.
std::vector<mat4> nodesAt(const Model& model, const Clip& clip, double time);

// How much more than at rest, one a morph of the part; empty: the clip says nothing of them.
std::vector<float> morphsAt(const ModelPart& part, const Clip& clip, double time);

}  // namespace rivulet
