#include "engine/scene/import/assimp_file.h"

#include <fmt/format.h>

#include <assimp/config.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "engine/scene/model_check.h"

namespace rivulet {
namespace {

constexpr unsigned kMostCorners = 10'000;  // of a face

std::string extensionOf(const std::string& path) {
    std::string extension = std::filesystem::path(path).extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return extension;
}

// assimp duplicates an OBJ's vertex for each corner that uses it, so the lines of the file are counted instead.
size_t countBadObjVertices(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    std::string line;
    size_t bad = 0;
    while (std::getline(file, line)) {
        size_t start = line.find_first_not_of(" \t");
        if (start == std::string::npos || line[start] != 'v' || start + 1 >= line.size() ||
            (line[start + 1] != ' ' && line[start + 1] != '\t'))
            continue;
        const char* at = line.c_str() + start + 1;
        bool finite = true;
        for (int k = 0; k < 3; ++k) {
            char* end = nullptr;
            float x = std::strtof(at, &end);
            if (end == at) break;
            finite = finite && std::isfinite(x);
            at = end;
        }
        if (!finite) ++bad;
    }
    return bad;
}

// Vertices with a coordinate that is not finite, and those with one that is too large.
struct BadVertices {
    size_t infinite = 0, far = 0;
};

BadVertices countBadVertices(const aiScene& scene) {
    BadVertices bad;
    for (unsigned m = 0; m < scene.mNumMeshes; ++m)
        for (unsigned i = 0; i < scene.mMeshes[m]->mNumVertices; ++i) {
            const aiVector3D& p = scene.mMeshes[m]->mVertices[i];
            const float longest = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
            if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
                ++bad.infinite;
            else if (longest > kFarthest)
                ++bad.far;
        }
    return bad;
}

// Splitting a polygon takes time with at least the square of its corners.
unsigned mostCorners(const aiScene& scene) {
    unsigned most = 0;
    for (unsigned m = 0; m < scene.mNumMeshes; ++m)
        for (unsigned f = 0; f < scene.mMeshes[m]->mNumFaces; ++f) most = std::max(most, scene.mMeshes[m]->mFaces[f].mNumIndices);
    return most;
}

bool indicesInRange(const aiScene& scene) {
    for (unsigned m = 0; m < scene.mNumMeshes; ++m) {
        const aiMesh& part = *scene.mMeshes[m];
        for (unsigned f = 0; f < part.mNumFaces; ++f)
            for (unsigned k = 0; k < part.mFaces[f].mNumIndices; ++k)
                if (part.mFaces[f].mIndices[k] >= part.mNumVertices) return false;
    }
    return true;
}

Status checkFile(const std::string& path) {
    std::error_code error;
    std::filesystem::file_status status = std::filesystem::status(path, error);
    if (status.type() == std::filesystem::file_type::not_found) return badInput("cannot be read: there is no such file");
    if (error) return badInput(fmt::format("cannot be read: {}", error.message()));
    if (std::filesystem::is_directory(status)) return badInput("is a folder; name an OBJ, glTF, FBX, PLY or STL file in it");
    if (!std::filesystem::is_regular_file(status)) return badInput("is not a plain file; name an OBJ, glTF, FBX, PLY or STL file");
    std::ifstream file(path, std::ios::binary);
    if (!file) return badInput("cannot be opened: check its permissions");
    if (std::filesystem::file_size(path, error) == 0) return badInput("is an empty file");
    if (extensionOf(path) == ".ply") {  // assimp 5.2 loops for ever on a header without end_header
        std::string head(size_t{1} << 16, '\0');
        file.read(head.data(), static_cast<std::streamsize>(head.size()));
        if (head.find("end_header") == std::string::npos) return badInput("cannot be read: its PLY header has no end");
    }
    return ok();
}

}  // namespace

Result<const aiScene*> readMeshFile(Assimp::Importer& importer, const FolderFiles& files, const std::string& path) {
    if (Status readable = checkFile(path); !readable) return readable.error();
    importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
    const aiScene* scene = importer.ReadFile(path, 0);  // without post-processing, which fails on NaN
    if (!files.refusal().empty()) return badInput(files.refusal());
    if (scene == nullptr) {
        std::string why = importer.GetErrorString();
        if (why.find("No suitable reader") != std::string::npos)
            return badInput(importer.IsExtensionSupported(extensionOf(path))
                                ? "cannot be read: it is damaged, or its format differs from its file name ending"
                                : "is of a kind that cannot be read; use OBJ, glTF, FBX, PLY or STL");
        if (why.find("out of range") != std::string::npos) return badInput(fmt::format("has an index out of range ({})", why));
        return badInput(fmt::format("cannot be read: {}", why));
    }
    BadVertices bad = countBadVertices(*scene);
    if (extensionOf(path) == ".obj") bad.infinite = std::max(bad.infinite > 0 ? size_t{1} : size_t{0}, countBadObjVertices(path));
    const auto vertices = [](size_t count) { return count == 1 ? "vertex" : "vertices"; };
    if (bad.infinite > 0) return badInput(fmt::format("has {} {} with NaN or infinite coordinates", bad.infinite, vertices(bad.infinite)));
    if (bad.far > 0)
        return badInput(fmt::format("has {} {} with coordinates above {:g}; scale it down", bad.far, vertices(bad.far), kFarthest));
    if (!indicesInRange(*scene)) return badInput("has a triangle whose index is out of range");
    if (scene->mNumMeshes == 0) return badInput("has no triangles");
    if (const unsigned corners = mostCorners(*scene); corners > kMostCorners)
        return badInput(fmt::format("has a face of {} corners, and at most {} are read; split it into triangles", corners, kMostCorners));
    return scene;
}

Result<const aiScene*> prepareMeshFile(Assimp::Importer& importer, unsigned steps) {
    const aiScene* scene = importer.ApplyPostProcessing(steps);
    if (scene != nullptr) return scene;
    const std::string why = importer.GetErrorString();
    if (why.empty() || why.find("No output meshes") != std::string::npos) return badInput("has no triangles");
    return badInput(fmt::format("has no triangles that can be used ({})", why));
}

}  // namespace rivulet
