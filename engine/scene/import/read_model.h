// Reads a model file through assimp (OBJ, glTF, FBX, PLY, STL and its other formats), or a picture.
#pragma once

#include <string>

#include "engine/core/result.h"
#include "engine/scene/model.h"

namespace rivulet {

// What importMesh, importModel, importWhole and importImage (engine/scene/import_model.h) return; a mesh is the only part of its model, and
// an image is the colour of the only triangle of its model. Error: a phrase about the file; of an image a sentence.
enum class ReadAs { mesh, model, whole, image };
Result<Model> readModel(const std::string& path, ReadAs as);

}  // namespace rivulet
