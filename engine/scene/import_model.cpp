#include "engine/scene/import_model.h"

#include "engine/scene/import_process.h"

namespace rivulet {

Result<Mesh> importMesh(const std::string& path) {
    Result<Model> model = importThrough(importProgram(), "mesh", path);
    if (!model) return model.error();
    return std::move(model->parts.at(0).mesh);
}

Result<Model> importModel(const std::string& path) { return importThrough(importProgram(), "model", path); }

Result<Model> importWhole(const std::string& path) { return importThrough(importProgram(), "whole", path); }

}  // namespace rivulet
