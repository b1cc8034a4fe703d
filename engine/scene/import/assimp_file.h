// Shared by all that reads through assimp: checks a file and reads it without post-processing. An error is a phrase about the file: "has no
// triangles".
#pragma once

#include <assimp/scene.h>
#include <assimp/Importer.hpp>

#include <string>

#include "engine/core/result.h"
#include "engine/scene/import/folder_files.h"
#include "engine/scene/mesh.h"

namespace rivulet {

// The contents of the file without post-processing: finite vertices, indices in range, at least one mesh. The importer owns the scene, and
// opens files through `files`. Error: the file is missing, a folder, empty, unreadable, of an unknown format, violates one of these
// conditions, names a file outside its folder, or has a face of more than 10,000 corners.
Result<const aiScene*> readMeshFile(Assimp::Importer& importer, const FolderFiles& files, const std::string& path);

// Applies `steps` (aiProcess flags) to the scene that was read. Error: no triangles are left.
Result<const aiScene*> prepareMeshFile(Assimp::Importer& importer, unsigned steps);

// All triangles of a file that was read, as one mesh. Error: as prepareMeshFile.
Result<Mesh> meshFrom(Assimp::Importer& importer, const std::string& path);

// The texture coordinates of a vertex; 0 where the file has no finite ones.
vec2 uvOf(const aiMesh& part, unsigned vertex);

}  // namespace rivulet
