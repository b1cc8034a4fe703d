// Reads a mesh file through assimp: OBJ, glTF, PLY, STL and what else it knows.
#pragma once

#include <string>

#include "engine/core/result.h"
#include "engine/scene/mesh.h"

namespace rivulet {

// All of the file's triangles as one mesh, each node's transform applied, in the file's own unit. Polygons become triangles; points and
// lines are dropped. Normals are the file's, or smooth ones where a part has none; uvs are the first channel, kept if every part has it.
// Error: the file is missing, a folder, empty, unreadable or of an unknown kind; it has no triangles, vertices that are not finite numbers
// (and how many), or an index out of range.
Result<Mesh> importMesh(const std::string& path);

}  // namespace rivulet
