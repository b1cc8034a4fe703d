// Meshes to files: OBJ and PLY.
#pragma once

#include <string>

#include "engine/core/mesh_view.h"
#include "engine/core/result.h"
#include "engine/core/table.h"
#include "fluid/io/export_frame.h"

namespace rivulet {

struct MeshFormat {
    const char* name;  // and the file's ending
    const char* doc;
    std::string (*write)(const MeshView& mesh, const ExportFrame& frame);  // the file's bytes
};
const Table<MeshFormat>& meshFormats();

// Metres; with normals if the mesh has them. Numbers read back exactly, except one bit of the first number of some PLY files, see
// mesh_file.cpp.
std::string writeObj(const MeshView& mesh, const ExportFrame& frame = {});
std::string writePly(const MeshView& mesh, const ExportFrame& frame = {});  // binary, little-endian

}  // namespace rivulet
