// Animation: the transforms of a model's nodes and the morph weights of its parts at a given time of a clip.
#pragma once

#include "engine/scene/model.h"

namespace rivulet {

// Values between keys are interpolated linearly, also where a glTF file has STEP or CUBICSPLINE: assimp 5.2 passes on neither the mode nor
// the tangents.

// Each node's matrix to its parent, in the order of model.nodes; nodes without a track keep theirs. `time` in s.
std::vector<mat4> nodesAt(const Model& model, const Clip& clip, double time);

// The weights of the part's morphs minus their rest weights, one per morph; empty: the clip has no morph track for the part.
std::vector<float> morphsAt(const ModelPart& part, const Clip& clip, double time);

}  // namespace rivulet
