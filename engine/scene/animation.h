// Animation: where a model's nodes are, and how its parts are bent, at a time of one of its clips.
#pragma once

#include "engine/scene/model.h"

namespace rivulet {

// Each node's matrix to its parent, in the order of model.nodes; those without a track stand as they do. `time` s.
std::vector<mat4> nodesAt(const Model& model, const Clip& clip, double time);

// One a morph of the part; empty: the clip says nothing of them.
std::vector<float> morphsAt(const ModelPart& part, const Clip& clip, double time);

}  // namespace rivulet
