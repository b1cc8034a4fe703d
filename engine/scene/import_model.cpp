#include "engine/scene/import_model.h"

#include "engine/scene/import/read_model.h"

namespace rivulet {

Result<Mesh> importMesh(const std::string& path) {
    Result<Model> model = readModel(path, ReadAs::mesh);
    if (!model) return model.error();
    return std::move(model->parts.at(0).mesh);
}

Result<Model> importModel(const std::string& path) { return readModel(path, ReadAs::model); }

Result<Model> importWhole(const std::string& path) { return readModel(path, ReadAs::whole); }

}  // namespace rivulet
