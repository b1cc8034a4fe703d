// Target model: models as the program reads them. The first byte picks the format, the rest is the file.
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "engine/scene/import_model.h"
#include "tests/fuzzers/target.h"

namespace rivulet::fuzzers {

namespace {
constexpr std::array kEndings = {".obj", ".gltf", ".glb", ".ply", ".stl", ".off"};

// Of the models that come with the project, those of at most 64 KB.
void add(std::vector<std::string>& all, const std::filesystem::path& folder) {
    for (const auto& file : std::filesystem::recursive_directory_iterator(folder)) {
        if (!file.is_regular_file() || file.file_size() > 65536) continue;
        for (size_t k = 0; k < kEndings.size(); ++k) {
            if (file.path().extension() != kEndings[k]) continue;
            std::ifstream stream(file.path(), std::ios::binary);
            std::stringstream text;
            text << stream.rdbuf();
            all.push_back(static_cast<char>(k) + text.str());
        }
    }
}
}  // namespace

void runModel(Bytes bytes) {
    if (bytes.empty()) return;
    const std::string path = fileOf(bytes.subspan(1), kEndings[static_cast<size_t>(bytes[0]) % kEndings.size()]);
    const Result<Model> model = importModel(path);
    if (!model) {
        requireSentence(model.error().message);
        return;
    }
    for (const ModelPart& part : model->parts) {
        for (const uint32_t i : part.mesh.indices) require(i < part.mesh.positions.size(), "indices are of vertices");
        for (const vec3& p : part.mesh.positions)
            require(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z), "vertices are finite");
    }
}

std::vector<std::string> modelSeeds() {
    std::vector<std::string> all = {
        std::string("\0", 1) + "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\nf 1/1/1 2/1/1 3/1/1\n",
        std::string("\3", 1) +
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
            "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
        std::string("\5", 1) + "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"};
    add(all, std::filesystem::path(RIVULET_SOURCE_DIR) / "tests" / "meshes");
    return all;
}

}  // namespace rivulet::fuzzers
