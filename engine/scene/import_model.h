// Reads a model file through assimp: glTF or FBX with its materials, textures, morph targets, bones, clips, cameras and lights, or a plain
// mesh as a model of one part.
#pragma once

#include <string>

#include "engine/core/result.h"
#include "engine/scene/model.h"

namespace rivulet {

// In the file's own unit; every part in its node's frame. Polygons become triangles. Normals are the file's, or smooth ones where a part
// has none. Vertices of what morphs or has bones are those of the file, in its order; others that are identical are joined. Textures lie
// in the file or beside it.
// Error: as importMesh; a texture that is missing or damaged, by name; indices of bones out of range.
Result<Model> importModel(const std::string& path);

// The same, but a file that says no more than where its triangles are (no materials, movement, cameras or lights) is one part on one node,
// as importMesh has it.
Result<Model> importWhole(const std::string& path);

}  // namespace rivulet
