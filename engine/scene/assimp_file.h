// What every import through assimp shares: a file that is checked, read raw, and refused in one sentence.
#pragma once

#include <assimp/scene.h>
#include <assimp/Importer.hpp>

#include <string>
#include <string_view>

#include "engine/core/result.h"
#include "engine/scene/mesh.h"

namespace rivulet {

// "the mesh 'x.obj' has no triangles": what is wrong with a mesh file, as bad input.
Error meshFileError(const std::string& path, std::string_view what);

// The file as it is, before any post-processing: finite vertices, indices in range, at least one mesh. The importer owns the scene.
// Error: the file is missing, a folder, empty, unreadable or of an unknown kind, or what is in it is none of that.
Result<const aiScene*> readMeshFile(Assimp::Importer& importer, const std::string& path);

// Does what `steps` (aiProcess flags) say. Error: no triangles are left.
Result<const aiScene*> prepareMeshFile(Assimp::Importer& importer, const std::string& path, unsigned steps);

// What importMesh makes of a file that was read. Error: as prepareMeshFile.
Result<Mesh> meshFrom(Assimp::Importer& importer, const std::string& path);

}  // namespace rivulet
