// Targets model (the answer of rivulet_import) and model_file (files that rivulet_import reads, in a process of its own).
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

#include "engine/scene/animation.h"
#include "engine/scene/import_process.h"
#include "engine/scene/mesh.h"
#include "engine/scene/model_check.h"
#include "engine/scene/model_wire.h"
#include "engine/scene/skin.h"
#include "tests/fuzzers/target.h"
#include "tests/unit/whole_model.h"

namespace rivulet::fuzzers {

namespace {

constexpr std::array kEndings = {".obj", ".gltf", ".glb", ".ply", ".stl", ".off"};
constexpr std::array kReaders = {"mesh", "model", "whole"};
constexpr size_t kLargestSeed = 65536;  // bytes

std::string wireOf(const Model& model) {
    std::string bytes;
    const bool sent = sendModel(model, [&bytes](Bytes more) {
        bytes.append(reinterpret_cast<const char*>(more.data()), more.size());
        return true;
    });
    require(sent, "a model can be sent");
    return bytes;
}

// The models that come with the project.
std::vector<std::filesystem::path> shippedModels() {
    std::vector<std::filesystem::path> all;
    for (const char* folder : {"tests/meshes", "assets"})
        for (const auto& file : std::filesystem::recursive_directory_iterator(std::filesystem::path(RIVULET_SOURCE_DIR) / folder))
            if (file.is_regular_file() && std::ranges::find(kEndings, file.path().extension().string()) != kEndings.end())
                all.push_back(file.path());
    std::ranges::sort(all);
    return all;
}

// What the program does with any model: poses, bounds, normals, skinning.
void use(const Model& model) {
    for (const Clip& clip : model.clips)
        for (const double time : {-1.0, 0.0, 0.4 * clip.seconds, 2 * clip.seconds}) {
            const std::vector<mat4> world = model.worldMatrices(nodesAt(model, clip, time));
            for (const ModelPart& part : model.parts) {
                (void)morphsAt(part, clip, time);
                (void)model.boneMatrices(part, world);
            }
        }
    const std::vector<mat4> world = model.worldMatrices();
    for (const ModelPart& part : model.parts) {
        Mesh mesh = transformed(part.mesh, world.at(static_cast<size_t>(part.node)));
        recomputeNormals(mesh);
        (void)mesh.bounds();
        Result<Deformer> skin = Deformer::create(device(), part);
        if (!skin) {
            requireSentence(skin.error().message);
            continue;
        }
        skin->run(std::vector<float>(part.morphs.size(), 0.5F), model.boneMatrices(part, world));
        skin->run(part.restWeights);
    }
}

}  // namespace

void runModel(Bytes bytes) {
    const Result<Model> model = receiveModel(bytes);
    if (!model) return requireSentence(model.error().message);
    require(faultOf(*model).empty(), "a model that is received has no fault");
    const std::string again = wireOf(*model);
    const Result<Model> second = receiveModel(bytesOf(again));
    require(second && wireOf(*second) == again, "it is sent and received again, to the same");
    use(*model);
}

std::vector<std::string> modelSeeds() {
    std::vector<std::string> all = {wireOf(whole_model::everything())};
    for (const char* fault : {"has no triangles", "has a name \x1B[31m with a control character", ""}) {
        std::string bytes;
        (void)sendFault(fault, [&bytes](Bytes more) {
            bytes.append(reinterpret_cast<const char*>(more.data()), more.size());
            return true;
        });
        all.push_back(bytes);
    }
    for (const std::filesystem::path& path : shippedModels()) {
        if (std::filesystem::file_size(path) > kLargestSeed) continue;
        const Result<Model> model = importThrough(importProgram(), "model", path.string());
        if (!model) continue;  // the broken ones of tests/meshes
        if (std::string bytes = wireOf(*model); bytes.size() <= kLargestSeed) all.push_back(std::move(bytes));
    }
    return all;
}

void runModelFile(Bytes bytes) {
    if (bytes.empty()) return;
    const auto kind = static_cast<size_t>(bytes[0]);
    const std::string path = fileOf(bytes.subspan(1), kEndings[kind % kEndings.size()]);
    constexpr ImportLimits kLimits{
        .memory = size_t{1} << 30U, .seconds = 5, .wall = std::chrono::seconds(40), .answer = size_t{256} << 20U};
    const auto from = std::chrono::steady_clock::now();
    const Result<Model> model = importThrough(importProgram(), kReaders[kind / kEndings.size() % kReaders.size()], path, kLimits);
    require(std::chrono::steady_clock::now() - from < kLimits.wall, "a reader ends by itself: it has a limit of processor time");
    if (!model) return requireSentence(model.error().message);
    require(faultOf(*model).empty(), "a model that is received has no fault");
}

std::vector<std::string> modelFileSeeds() {
    std::vector<std::string> all = {
        std::string("\0", 1) + "mtllib no.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\nf 1/1/1 2/1/1 3/1/1\n",
        std::string("\3", 1) +
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
            "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
        std::string("\4", 1) +
            "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n",
        std::string("\5", 1) + "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"};
    const std::string gltf =
        R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}], "nodes": [{"mesh": 0, "name": "n"}, {"camera": 0,
"translation": [0, 0, 1]}], "cameras": [{"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.1}}], "meshes": [{"weights": [0.5],
"primitives": [{"attributes": {"POSITION": 0}, "material": 0, "targets": [{"POSITION": 0}]}]}], "materials": [{"alphaMode": "BLEND",
"pbrMetallicRoughness": {"baseColorFactor": [1, 0, 0, 0.5]}}], "animations": [{"channels": [{"sampler": 0, "target": {"node": 0, "path":
"translation"}}], "samplers": [{"input": 1, "output": 0}]}], "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
"min": [0, 0, 0], "max": [1, 1, 0]}, {"bufferView": 1, "componentType": 5126, "count": 3, "type": "SCALAR", "min": [0], "max": [2]}],
"bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 12}], "buffers": [{"byteLength": 48,
"uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAgD8AAABA"}]})";
    for (size_t reader = 0; reader < kReaders.size(); ++reader) all.push_back(static_cast<char>(reader * kEndings.size() + 1) + gltf);
    for (const std::filesystem::path& path : shippedModels()) {
        if (std::filesystem::file_size(path) > kLargestSeed) continue;
        const auto kind = static_cast<char>(std::ranges::find(kEndings, path.extension().string()) - kEndings.begin());
        all.push_back(kind + contentsOf(path));
    }
    return all;
}

}  // namespace rivulet::fuzzers
