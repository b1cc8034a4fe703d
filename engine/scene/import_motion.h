// What a file says of movement, cameras and light: read beside its parts by importModel.
#pragma once

#include <assimp/scene.h>

#include <map>
#include <string>

#include "engine/scene/model.h"

namespace rivulet {

// assimp's rows are glm's columns.
mat4 matrixOf(const aiMatrix4x4& m);
vec3 vectorOf(const aiVector3D& v);

// Fills model.clips, cameras and lights. `nodeOf`: model.nodes by name; what names none of them is left out, as are keys that are not
// finite or not later than the one before. `gltf`: of a glTF file, which assimp counts some angles of in a way of its own.
void importMotion(const aiScene& scene, const std::map<std::string, int>& nodeOf, bool gltf, Model& model);

}  // namespace rivulet
