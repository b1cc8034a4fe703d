// Reads a model file through assimp: OBJ, glTF, FBX, PLY, STL and its other formats.
#pragma once

#include <string>

#include "engine/core/result.h"
#include "engine/scene/model.h"

namespace rivulet {

// What importMesh, importModel and importWhole (engine/scene/import_model.h) return; a mesh is the only part of its model. Error: a phrase
// about the file.
enum class ReadAs { mesh, model, whole };
Result<Model> readModel(const std::string& path, ReadAs as);

}  // namespace rivulet
