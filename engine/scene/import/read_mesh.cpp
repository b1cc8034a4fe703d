// All triangles of a file as one mesh.
#include <assimp/postprocess.h>

#include <cmath>
#include <filesystem>

#include "engine/scene/import/assimp_file.h"
#include "engine/scene/model_check.h"

namespace rivulet {
namespace {

void append(const aiMesh& part, bool withUvs, Mesh& mesh) {
    auto base = static_cast<uint32_t>(mesh.positions.size());
    for (unsigned i = 0; i < part.mNumVertices; ++i) {
        const aiVector3D& p = part.mVertices[i];
        mesh.positions.emplace_back(p.x, p.y, p.z);
        vec3 n = part.HasNormals() ? vec3(part.mNormals[i].x, part.mNormals[i].y, part.mNormals[i].z) : vec3(0.0F);
        float length = glm::length(n);
        mesh.normals.push_back(length > 0.0F && std::isfinite(length) ? n / length : vec3(0.0F, 1.0F, 0.0F));
        if (withUvs) mesh.uvs.push_back(uvOf(part, i));
    }
    for (unsigned f = 0; f < part.mNumFaces; ++f)
        if (part.mFaces[f].mNumIndices == 3)
            for (unsigned k = 0; k < 3; ++k) mesh.indices.push_back(base + part.mFaces[f].mIndices[k]);
}

}  // namespace

vec2 uvOf(const aiMesh& part, unsigned vertex) {
    const aiVector3D& uv = part.mTextureCoords[0][vertex];
    return std::abs(uv.x) <= kFarthest && std::abs(uv.y) <= kFarthest ? vec2(uv.x, uv.y) : vec2(0.0F);
}

Result<Mesh> meshFrom(Assimp::Importer& importer, const std::string& path) {
    Result<const aiScene*> scene =
        prepareMeshFile(importer, aiProcess_Triangulate | aiProcess_SortByPType | aiProcess_PreTransformVertices |
                                      aiProcess_GenSmoothNormals | aiProcess_JoinIdenticalVertices);
    if (!scene) return scene.error();

    Mesh mesh;
    mesh.name = std::filesystem::path(path).stem().string();
    bool withUvs = true;
    for (unsigned m = 0; m < (*scene)->mNumMeshes; ++m) withUvs = withUvs && (*scene)->mMeshes[m]->HasTextureCoords(0);
    for (unsigned m = 0; m < (*scene)->mNumMeshes; ++m) append(*(*scene)->mMeshes[m], withUvs, mesh);
    if (mesh.indices.empty()) return badInput("has no triangles");
    return mesh;
}

}  // namespace rivulet
