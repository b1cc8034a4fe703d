#include "engine/scene/import_model.h"

#include <fmt/format.h>

#include "engine/scene/import_process.h"

namespace rivulet {

Result<Mesh> importMesh(const std::string& path) {
    Result<Model> model = importThrough(importProgram(), "mesh", path);
    if (!model) return model.error();
    return std::move(model->parts.at(0).mesh);
}

Result<Model> importModel(const std::string& path) { return importThrough(importProgram(), "model", path); }

Result<Model> importWhole(const std::string& path) { return importThrough(importProgram(), "whole", path); }

Result<std::shared_ptr<const Image>> importImage(const std::string& path) {
    Result<Model> model = importThrough(importProgram(), "image", path);
    if (!model) return model.error();
    std::shared_ptr<const Image> image = model->parts.at(0).material.colour;
    if (image == nullptr) return badInput(fmt::format("the image '{}' cannot be read: its reader sent none; save it again", path));
    return image;
}

}  // namespace rivulet
