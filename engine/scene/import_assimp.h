// Reads a mesh file through assimp: OBJ, glTF, PLY, STL and its other formats.
#pragma once

#include <string>

#include "engine/core/result.h"
#include "engine/scene/mesh.h"

namespace rivulet {

// All triangles of the file as one mesh, with each node's transform applied, in the unit of the file. Polygons become triangles; points and
// lines are dropped. Normals are the file's, or smooth ones for a part without normals; uvs are the first channel, if every part has it.
// Error (badInput): the file is missing, a folder, empty, unreadable or of an unknown format; it has no triangles, vertices that are not
// finite (with their number), or an index out of range.
Result<Mesh> importMesh(const std::string& path);

}  // namespace rivulet
