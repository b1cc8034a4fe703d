#include "engine/scene/import/read_model.h"

#include <fmt/format.h>

#include <assimp/GltfMaterial.h>
#include <assimp/postprocess.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <functional>
#include <map>

#include "engine/scene/import/assimp_file.h"
#include "engine/scene/import/read_motion.h"
#include "engine/scene/import/sandbox.h"
#include "engine/scene/load_image.h"

namespace rivulet {
namespace {

// The textures of a file; each is decoded once.
class Textures {
  public:
    Textures(const aiScene& scene, const FolderFiles& files, const std::string& path) : scene_(scene), files_(files), path_(path) {}

    // Null if the material has no texture of that kind.
    Result<std::shared_ptr<const Image>> of(const aiMaterial& material, aiTextureType type, unsigned index = 0) {
        aiString name;
        if (material.GetTexture(type, index, &name) != aiReturn_SUCCESS) return std::shared_ptr<const Image>();
        const std::string key = name.C_Str();
        if (const auto found = done_.find(key); found != done_.end()) return found->second;
        Result<Image> image = read(key);
        if (!image) return image.error();
        return done_[key] = std::make_shared<const Image>(std::move(*image));
    }

  private:
    Result<Image> read(const std::string& name) const {
        const aiTexture* embedded = scene_.GetEmbeddedTexture(name.c_str());
        if (embedded == nullptr) {
            const Result<std::string> file = files_.resolve((std::filesystem::path(path_).parent_path() / name).string());
            if (!file) return file.error();
            return loadImage(*file);
        }
        const std::string called = fmt::format("{}, embedded texture {}", path_, name);
        if (embedded->mHeight != 0) return badInput(fmt::format("the picture '{}' is not compressed; use PNG or JPEG", called));
        return decodeImage(std::as_bytes(std::span(reinterpret_cast<const char*>(embedded->pcData), embedded->mWidth)), called);
    }
    const aiScene& scene_;
    const FolderFiles& files_;
    const std::string& path_;
    std::map<std::string, std::shared_ptr<const Image>> done_;
};

Result<Material> materialOf(const aiMaterial& from, Textures& textures) {
    Material to;
    aiColor4D base(1, 1, 1, 1);
    if (from.Get(AI_MATKEY_BASE_COLOR, base) != aiReturn_SUCCESS) (void)from.Get(AI_MATKEY_COLOR_DIFFUSE, base);
    to.baseColour = vec3(base.r, base.g, base.b);
    (void)from.Get(AI_MATKEY_METALLIC_FACTOR, to.metallic);
    (void)from.Get(AI_MATKEY_ROUGHNESS_FACTOR, to.roughness);
    aiColor3D emission(0, 0, 0);
    if (from.Get(AI_MATKEY_COLOR_EMISSIVE, emission) == aiReturn_SUCCESS) {
        to.emission = vec3(emission.r, emission.g, emission.b);
        if (!isFinite(to.emission)) to.emission = vec3(0.0F);
    }
    aiString mode;
    if (from.Get(AI_MATKEY_GLTF_ALPHAMODE, mode) == aiReturn_SUCCESS) {
        to.blended = mode == aiString("BLEND");
        if (mode == aiString("MASK")) {
            to.cutoff = 0.5F;
            (void)from.Get(AI_MATKEY_GLTF_ALPHACUTOFF, to.cutoff);
        }
    }
    if (to.blended || to.cutoff > 0) to.opacity = base.a;
    int twoSided = 1;
    if (from.Get(AI_MATKEY_TWOSIDED, twoSided) == aiReturn_SUCCESS) to.doubleSided = twoSided != 0;
    const struct {
        aiTextureType type;
        std::shared_ptr<const Image>* into;
    } wanted[] = {{aiTextureType_BASE_COLOR, &to.colour},
                  {aiTextureType_DIFFUSE, &to.colour},
                  {aiTextureType_METALNESS, &to.metallicRoughness},
                  {aiTextureType_UNKNOWN, &to.metallicRoughness},  // assimp 5.2 stores glTF's here
                  {aiTextureType_NORMALS, &to.normals},
                  {aiTextureType_LIGHTMAP, &to.occlusion},  // assimp 5.2 stores glTF's here
                  {aiTextureType_EMISSIVE, &to.glow}};
    for (const auto& w : wanted) {
        if (*w.into) continue;
        Result<std::shared_ptr<const Image>> image = textures.of(from, w.type);
        if (!image) return image.error();
        *w.into = std::move(*image);
    }
    return to;
}

std::vector<MorphTarget> morphsOf(const aiMesh& from) {
    std::vector<MorphTarget> morphs;
    for (unsigned k = 0; k < from.mNumAnimMeshes; ++k) {
        const aiAnimMesh& target = *from.mAnimMeshes[k];
        MorphTarget morph;
        morph.name = target.mName.C_Str();
        for (unsigned i = 0; target.mVertices != nullptr && i < std::min(target.mNumVertices, from.mNumVertices); ++i) {
            const vec3 offset = vectorOf(target.mVertices[i]) - vectorOf(from.mVertices[i]);
            if (offset == vec3(0.0F) || !isFinite(offset)) continue;
            morph.vertices.push_back(i);
            morph.offsets.push_back(offset);
        }
        morphs.push_back(std::move(morph));
    }
    return morphs;
}

// Applies the morph weights of the file to the mesh; they hold while no clip sets others.
void rest(const aiMesh& from, ModelPart& part) {
    for (unsigned k = 0; k < from.mNumAnimMeshes; ++k) {
        const float weight = from.mAnimMeshes[k]->mWeight;
        if (weight == 0.0F || !std::isfinite(weight)) continue;
        part.restWeights.resize(part.morphs.size(), 0.0F);
        part.restWeights[k] = weight;
        const MorphTarget& morph = part.morphs[k];
        for (size_t i = 0; i < morph.vertices.size(); ++i) part.mesh.positions[morph.vertices[i]] += weight * morph.offsets[i];
    }
    if (!part.restWeights.empty()) recomputeNormals(part.mesh);
}

// The four bones of largest weight of each vertex, with weights normalised to a sum of 1.
Status gripsOf(const aiMesh& from, const std::map<std::string, int>& nodeOf, ModelPart& part) {
    if (from.mNumBones == 0) return ok();
    part.grips.resize(from.mNumVertices);
    for (unsigned b = 0; b < from.mNumBones; ++b) {
        const aiBone& bone = *from.mBones[b];
        const auto node = nodeOf.find(bone.mName.C_Str());
        if (node == nodeOf.end()) return badInput(fmt::format("has a bone '{}' without a node of that name", bone.mName.C_Str()));
        part.bones.push_back({node->second, matrixOf(bone.mOffsetMatrix)});
        for (unsigned w = 0; w < bone.mNumWeights; ++w) {
            const aiVertexWeight& weight = bone.mWeights[w];
            if (weight.mVertexId >= from.mNumVertices) return badInput("has a bone with a vertex index out of range");
            if (!(weight.mWeight > 0)) continue;
            Grip& grip = part.grips[weight.mVertexId];
            int least = 0;
            for (int k = 1; k < 4; ++k)
                if (grip.weight[k] < grip.weight[least]) least = k;
            if (weight.mWeight <= grip.weight[least]) continue;
            grip.weight[least] = weight.mWeight;
            grip.bone[least] = b;
        }
    }
    for (Grip& grip : part.grips) {
        const float sum = grip.weight.x + grip.weight.y + grip.weight.z + grip.weight.w;
        grip.weight = sum > 0 ? grip.weight / sum : vec4(1, 0, 0, 0);
    }
    return ok();
}

Mesh meshOf(const aiMesh& from) {
    Mesh mesh;
    mesh.name = from.mName.C_Str();
    for (unsigned i = 0; i < from.mNumVertices; ++i) {
        mesh.positions.push_back(vectorOf(from.mVertices[i]));
        const vec3 n = from.HasNormals() ? vectorOf(from.mNormals[i]) : vec3(0.0F);
        const float length = glm::length(n);
        mesh.normals.push_back(length > 0.0F && std::isfinite(length) ? n / length : vec3(0.0F, 1.0F, 0.0F));
        if (from.HasTextureCoords(0)) mesh.uvs.push_back(uvOf(from, i));
    }
    for (unsigned f = 0; f < from.mNumFaces; ++f)
        if (from.mFaces[f].mNumIndices == 3)
            for (unsigned k = 0; k < 3; ++k) mesh.indices.push_back(from.mFaces[f].mIndices[k]);
    return mesh;
}

bool moves(const aiScene& scene) {
    for (unsigned m = 0; m < scene.mNumMeshes; ++m)
        if (scene.mMeshes[m]->mNumAnimMeshes > 0 || scene.mMeshes[m]->mNumBones > 0) return true;
    return false;
}

bool isGltf(const std::string& path) {
    std::string ending = std::filesystem::path(path).extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return ending == ".gltf" || ending == ".glb";
}

// Whether the material is in the file: assimp adds a default material, in glTF files as the last one.
bool isFiles(const aiScene& scene, unsigned material, bool gltf) {
    if (gltf) return material + 1 < scene.mNumMaterials;
    const aiString name = scene.mMaterials[material]->GetName();
    return name.length > 0 && name != aiString(AI_DEFAULT_MATERIAL_NAME);
}

bool anyDressed(const aiScene& scene, bool gltf) {
    for (unsigned m = 0; m < scene.mNumMeshes; ++m)
        if (isFiles(scene, scene.mMeshes[m]->mMaterialIndex, gltf)) return true;
    return false;
}

bool hasMoreThanTriangles(const aiScene& scene, bool gltf) {
    return anyDressed(scene, gltf) || moves(scene) || scene.mNumAnimations > 0 || scene.mNumCameras > 0 || scene.mNumLights > 0;
}

Result<Model> modelFrom(Assimp::Importer& importer, const FolderFiles& files, const std::string& path) {
    const bool gltf = isGltf(path);
    unsigned steps = aiProcess_Triangulate | aiProcess_SortByPType | aiProcess_GenSmoothNormals;
    if (!moves(*importer.GetScene())) steps |= aiProcess_JoinIdenticalVertices;
    Result<const aiScene*> scene = prepareMeshFile(importer, steps);
    if (!scene) return scene.error();

    Model model;
    Textures textures(**scene, files, path);
    std::vector<Material> materials;
    for (unsigned m = 0; m < (*scene)->mNumMaterials; ++m) {
        Result<Material> material = materialOf(*(*scene)->mMaterials[m], textures);
        if (!material) return material.error();
        materials.push_back(std::move(*material));
    }
    std::map<std::string, int> nodeOf;
    std::vector<std::pair<unsigned, int>> placed;  // a mesh and its node
    const std::function<void(const aiNode&, int)> walk = [&](const aiNode& node, int parent) {
        const int here = static_cast<int>(model.nodes.size());
        model.nodes.push_back({node.mName.C_Str(), matrixOf(node.mTransformation), parent});
        nodeOf.emplace(node.mName.C_Str(), here);
        for (unsigned m = 0; m < node.mNumMeshes; ++m) placed.emplace_back(node.mMeshes[m], here);
        for (unsigned c = 0; c < node.mNumChildren; ++c) walk(*node.mChildren[c], here);
    };
    walk(*(*scene)->mRootNode, -1);
    for (const auto& [index, node] : placed) {
        const aiMesh& from = *(*scene)->mMeshes[index];
        ModelPart part;
        part.name = model.nodes[static_cast<size_t>(node)].name;
        if (part.name.empty() || (*scene)->mRootNode->mNumChildren == 0) part.name = from.mName.C_Str();
        part.mesh = meshOf(from);
        if (part.mesh.indices.empty()) continue;
        part.material = materials[from.mMaterialIndex];
        part.materialName = (*scene)->mMaterials[from.mMaterialIndex]->GetName().C_Str();
        part.hasMaterial = isFiles(**scene, from.mMaterialIndex, gltf);
        part.node = node;
        part.morphs = morphsOf(from);
        rest(from, part);
        if (Status held = gripsOf(from, nodeOf, part); !held) return held.error();
        model.parts.push_back(std::move(part));
    }
    if (model.parts.empty()) return badInput("has no triangles");
    readMotion(**scene, nodeOf, gltf, model);
    return model;
}

Result<Model> imageFrom(const std::string& path) {
    std::error_code none;
    const uintmax_t bytes = std::filesystem::file_size(path, none);
    if (!none) allowFor(bytes);
    Result<Image> image = loadImage(path);
    if (!image) return image.error();
    Model model;
    model.nodes.push_back({"image", mat4(1.0F), -1});
    ModelPart part;
    part.mesh.positions = {vec3(0, 0, 0), vec3(1, 0, 0), vec3(0, 1, 0)};
    part.mesh.indices = {0, 1, 2};
    part.material.colour = std::make_shared<const Image>(std::move(*image));
    model.parts.push_back(std::move(part));
    return model;
}

}  // namespace

Result<Model> readModel(const std::string& path, ReadAs as) try {
    if (as == ReadAs::image) return imageFrom(path);
    Assimp::Importer importer;
    auto* files = new FolderFiles(path);
    importer.SetIOHandler(files);  // which owns it
    Result<const aiScene*> raw = readMeshFile(importer, *files, path);
    if (!raw) return raw.error();
    const aiScene& scene = **raw;
    if (as == ReadAs::model || (as == ReadAs::whole && hasMoreThanTriangles(scene, isGltf(path)))) return modelFrom(importer, *files, path);
    Result<Mesh> mesh = meshFrom(importer, path);
    if (!mesh) return mesh.error();
    Model model;
    model.nodes.push_back({mesh->name, mat4(1.0F), -1});
    ModelPart part;
    part.name = mesh->name;
    part.mesh = std::move(*mesh);
    model.parts.push_back(std::move(part));
    return model;
} catch (const std::exception& e) {  // assimp reports most errors by text, others by throwing
    return badInput(fmt::format("cannot be read: {}", e.what()));
}

}  // namespace rivulet
