// Reads the animations, cameras and lights of a file, for readModel.
#pragma once

#include <assimp/scene.h>

#include <map>
#include <string>

#include "engine/scene/model.h"

namespace rivulet {

// Conversions from assimp; its matrices are row-major, glm's are column-major.
mat4 matrixOf(const aiMatrix4x4& m);
vec3 vectorOf(const aiVector3D& v);

// Fills model.clips, cameras and lights. `nodeOf`: indices of model.nodes by name. Tracks, cameras and lights of other nodes are dropped,
// and so are keys that are not finite or not later than the previous one. `gltf`: the file is glTF, for which assimp reports angles
// differently.
void readMotion(const aiScene& scene, const std::map<std::string, int>& nodeOf, bool gltf, Model& model);

}  // namespace rivulet
