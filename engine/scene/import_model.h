// Imports a mesh or a model from a file (OBJ, glTF, FBX, PLY, STL and the other formats of assimp), or a picture.
#pragma once

#include <memory>
#include <string>

#include "engine/core/result.h"
#include "engine/scene/model.h"

namespace rivulet {

// All triangles of the file as one mesh, with each node's transform applied, in the unit of the file. Polygons become triangles; points and
// lines are dropped. Normals are the file's, or smooth ones for a part without normals; uvs are the first channel, if every part has it.
// Error (badInput): the file is missing, a folder, empty, unreadable or of an unknown format; it has no triangles, vertices that are not
// finite (with their number), or an index out of range.
Result<Mesh> importMesh(const std::string& path);

// A model with its materials, textures, morph targets, bones, clips, cameras and lights, or a plain mesh as a model of one part.
// In the unit of the file; each part in the frame of its node. Polygons become triangles. Normals are the file's, or smooth ones for a part
// without normals. A part with morphs or bones keeps the vertices of the file in their order; in other parts identical vertices are merged.
// Textures are in the file or beside it.
// Error (badInput): as importMesh; a missing or damaged texture, with its name; bone indices out of range.
Result<Model> importModel(const std::string& path);

// The same, but a file that has only triangles (no materials, animations, cameras or lights) becomes one part on one node, as in
// importMesh.
Result<Model> importWhole(const std::string& path);

// A picture: PNG, JPEG, TGA or BMP. Error (badInput): as loadImage (load_image.h).
Result<std::shared_ptr<const Image>> importImage(const std::string& path);

}  // namespace rivulet
