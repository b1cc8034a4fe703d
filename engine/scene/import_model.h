// Reads a model file through assimp: glTF or FBX with its materials, textures, morph targets, bones, clips, cameras and lights, or a plain
// mesh as a model of one part.
#pragma once

#include <string>

#include "engine/core/result.h"
#include "engine/scene/model.h"

namespace rivulet {

// In the unit of the file; each part in the frame of its node. Polygons become triangles. Normals are the file's, or smooth ones for a part
// without normals. A part with morphs or bones keeps the vertices of the file in their order; in other parts identical vertices are merged.
// Textures are in the file or beside it.
// Error (badInput): as importMesh; a missing or damaged texture, with its name; bone indices out of range.
Result<Model> importModel(const std::string& path);

// The same, but a file that has only triangles (no materials, animations, cameras or lights) becomes one part on one node, as in
// importMesh.
Result<Model> importWhole(const std::string& path);

}  // namespace rivulet
