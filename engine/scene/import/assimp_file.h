// Shared by all imports through assimp: checks a file, reads it without post-processing, and makes error messages.
#pragma once

#include <assimp/scene.h>
#include <assimp/Importer.hpp>

#include <string>
#include <string_view>

#include "engine/core/result.h"
#include "engine/scene/mesh.h"

namespace rivulet {

// An error (badInput) about a mesh file: "the mesh 'x.obj' has no triangles".
Error meshFileError(const std::string& path, std::string_view what);

// The contents of the file without post-processing: finite vertices, indices in range, at least one mesh. The importer owns the scene.
// Error: the file is missing, a folder, empty, unreadable, of an unknown format, or violates one of these conditions.
Result<const aiScene*> readMeshFile(Assimp::Importer& importer, const std::string& path);

// Applies `steps` (aiProcess flags) to the scene that was read. Error: no triangles are left.
Result<const aiScene*> prepareMeshFile(Assimp::Importer& importer, const std::string& path, unsigned steps);

// All triangles of a file that was read, as one mesh. Error: as prepareMeshFile.
Result<Mesh> meshFrom(Assimp::Importer& importer, const std::string& path);

}  // namespace rivulet
