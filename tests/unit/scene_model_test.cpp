// importModel of glTF: parts, materials, textures, morphs and bones, or an error message.
#include <gtest/gtest.h>

#include <unistd.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <set>

#include "engine/core/json.h"
#include "engine/scene/import_model.h"
#include "engine/scene/load_image.h"

namespace rivulet::scene_model_test {
namespace {

const std::string kHead = std::string(RIVULET_SOURCE_DIR) + "/assets/meshes/head/";

class SceneModel : public ::testing::Test {
  protected:
    void SetUp() override {
        folder_ = std::filesystem::temp_directory_path() /
                  ("rivulet_model_" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()) + "_" +
                   std::to_string(::getpid()));
        std::filesystem::create_directories(folder_);
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }
    std::string write(const std::string& name, const std::string& bytes) {
        std::string path = (folder_ / name).string();
        std::ofstream(path, std::ios::binary) << bytes;
        return path;
    }
    // A triangle held by two bones, the second of which stands 2 m up, moved 3 m along x by its node; a morph that lifts one corner.
    std::string bonedTriangle(const std::string& image) {
        std::string data;
        auto floats = [&](std::initializer_list<float> all) {
            for (float f : all) data.append(reinterpret_cast<const char*>(&f), 4);
        };
        floats({0, 0, 0, 1, 0, 0, 0, 1, 0});                       // 0: positions, 36
        floats({0.25F, 0.125F, 1, 0, 0, 1});                       // 36: uvs, 24
        floats({1, 0, 0, 0, 0.5F, 0.5F, 0, 0, 0, 1, 0, 0});        // 60: weights, 48
        data += std::string("\0\1\0\0\0\1\0\0\0\1\0\0", 12);       // 108: joints, 12
        floats({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1});  // 120: inverse bind, 128
        floats({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -2, 0, 1});
        floats({0, 0, 0, 0, 0, 0, 0, 0, 0.5F});  // 248: morph, 36
        data += std::string("\0\0\1\0\2\0", 6);  // 284: indices
        write("triangle.bin", data);
        return write("triangle.gltf", R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,1]}],
"nodes":[{"name":"sheet","mesh":0,"skin":0,"translation":[3,0,0]},{"name":"root","children":[2]},{"name":"tip","translation":[0,2,0]}],
"skins":[{"joints":[1,2],"inverseBindMatrices":4}],
"meshes":[{"name":"m","primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":1,"WEIGHTS_0":2,"JOINTS_0":3},"indices":6,"material":0,
"targets":[{"POSITION":5}]}],"extras":{"targetNames":["lift"]}}],
"materials":[{"name":"leaf","alphaMode":"MASK","alphaCutoff":0.25,"doubleSided":true,"normalTexture":{"index":0},
"pbrMetallicRoughness":{"baseColorFactor":[0.5,0.25,1,0.75],"metallicFactor":0.125,"roughnessFactor":0.375,"metallicRoughnessTexture":{"index":0}}}],
"textures":[{"source":0}],"images":[{"uri":")" +
                                          image + R"("}],
"buffers":[{"uri":"triangle.bin","byteLength":290}],
"bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":24},{"buffer":0,"byteOffset":60,"byteLength":48},
{"buffer":0,"byteOffset":108,"byteLength":12},{"buffer":0,"byteOffset":120,"byteLength":128},{"buffer":0,"byteOffset":248,"byteLength":36},
{"buffer":0,"byteOffset":284,"byteLength":6}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},
{"bufferView":1,"componentType":5126,"count":3,"type":"VEC2"},{"bufferView":2,"componentType":5126,"count":3,"type":"VEC4"},
{"bufferView":3,"componentType":5121,"count":3,"type":"VEC4"},{"bufferView":4,"componentType":5126,"count":2,"type":"MAT4"},
{"bufferView":5,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[0,0,0.5]},
{"bufferView":6,"componentType":5123,"count":3,"type":"SCALAR"}]})");
    }
    std::filesystem::path folder_;
};

TEST_F(SceneModel, theHeadHasItsPartsMorphsAndTextures) {
    Result<Model> head = importModel(kHead + "head.glb");
    ASSERT_TRUE(head) << head.error().message;
    std::set<std::string> names;
    for (const ModelPart& part : head->parts) names.insert(part.name);
    EXPECT_EQ(names,
              (std::set<std::string>{"skin", "eyeLeft", "eyeRight", "caruncleLeft", "caruncleRight", "lashesLeft", "lashesRight",
                                     "lashDropsLeft", "lashDropsRight", "corneaLeft", "corneaRight", "teeth", "tongue", "brows", "hair"}));
    const ModelPart& skin = *head->find("skin");
    ASSERT_EQ(skin.morphs.size(), 21U);
    EXPECT_EQ(skin.morphs[0].name, "blinkLeft");
    for (const MorphTarget& morph : skin.morphs) {
        EXPECT_FALSE(morph.vertices.empty()) << morph.name;
        EXPECT_LT(morph.vertices.size(), skin.mesh.positions.size()) << morph.name << " is not sparse";
    }
    ASSERT_TRUE(skin.material.colour);
    EXPECT_EQ(skin.material.colour->width, 1024);
    EXPECT_FALSE(skin.material.blended);
    EXPECT_FALSE(skin.material.metallicRoughness);
    EXPECT_EQ(head->find("eyeLeft")->material.colour, head->find("eyeRight")->material.colour) << "one picture was decoded twice";
    EXPECT_TRUE(head->find("lashesLeft")->material.doubleSided);
    EXPECT_TRUE(head->find("corneaLeft")->material.blended);
    EXPECT_NEAR(head->find("corneaLeft")->material.opacity, 0.06F, 1e-6F);
    EXPECT_EQ(head->find("nobody"), nullptr);
}

TEST_F(SceneModel, uvsPointUpAsInHeadJson) {
    Result<Model> head = importModel(kHead + "head.glb");
    ASSERT_TRUE(head);
    const Mesh& skin = head->find("skin")->mesh;
    const vec3 tear(-0.020006F, 0.023357F, 0.037250F);
    size_t nearest = 0;
    for (size_t i = 0; i < skin.positions.size(); ++i)
        if (glm::distance(skin.positions[i], tear) < glm::distance(skin.positions[nearest], tear)) nearest = i;
    EXPECT_LT(glm::distance(skin.uvs[nearest], vec2(0.42845F, 0.60181F)), 0.01F);
    // And the picture's rows run up with them: lips are redder than the forehead.
    const Image& albedo = *head->find("skin")->material.colour;
    auto red = [&](float u, float v) {
        const size_t at = 4 * (static_cast<size_t>(v * 1024) * 1024 + static_cast<size_t>(u * 1024));
        return static_cast<float>(albedo.rgba[at]) / static_cast<float>(albedo.rgba[at + 1]);
    };
    EXPECT_GT(red(0.5F, 0.345F), 1.2F * red(0.5F, 0.75F));
}

TEST_F(SceneModel, bonesMorphsAndMaterialsAreTheFiles) {
    std::filesystem::copy_file(kHead + "skin_regions.png", folder_ / "marks.png");
    Result<Model> model = importModel(bonedTriangle("marks.png"));
    ASSERT_TRUE(model) << model.error().message;
    ASSERT_EQ(model->parts.size(), 1U);
    const ModelPart& part = model->parts[0];
    EXPECT_EQ(part.mesh.positions.size(), 3U);
    EXPECT_EQ(part.mesh.uvs[0], vec2(0.25F, 0.875F));
    EXPECT_NEAR(part.mesh.normals[1].z, 1.0F, 1e-6F);
    ASSERT_EQ(part.morphs.size(), 1U);
    EXPECT_EQ(part.morphs[0].name, "lift");
    EXPECT_EQ(part.morphs[0].vertices, std::vector<uint32_t>{2});
    EXPECT_EQ(part.morphs[0].offsets[0], vec3(0, 0, 0.5F));
    ASSERT_EQ(part.bones.size(), 2U);
    ASSERT_EQ(part.grips.size(), 3U);
    const std::vector<mat4> world = model->worldMatrices();
    const mat4 placed = world[static_cast<size_t>(part.node)];
    EXPECT_EQ(vec3(placed[3]), vec3(3, 0, 0));
    // At bind the bones leave every vertex in its place: node * bones = what glTF asks, which ignores the mesh's own node.
    for (const mat4& bone : model->boneMatrices(part, world)) EXPECT_LT(glm::length(vec3(placed * bone[3])), 1e-6F);
    int tip = part.bones[0].node;
    if (model->nodes[static_cast<size_t>(tip)].name != "tip") tip = part.bones[1].node;
    EXPECT_EQ(model->nodes[static_cast<size_t>(tip)].name, "tip");
    EXPECT_NEAR(part.grips[1].weight.x + part.grips[1].weight.y, 1.0F, 1e-6F);
    EXPECT_EQ(part.materialName, "leaf");
    const Material& m = part.material;
    EXPECT_EQ(m.baseColour, vec3(0.5F, 0.25F, 1.0F));
    EXPECT_EQ(m.opacity, 0.75F);
    EXPECT_EQ(m.cutoff, 0.25F);
    EXPECT_EQ(m.metallic, 0.125F);
    EXPECT_EQ(m.roughness, 0.375F);
    EXPECT_TRUE(m.doubleSided);
    EXPECT_TRUE(m.normals);
    EXPECT_TRUE(m.metallicRoughness);
}

TEST_F(SceneModel, aPictureThatIsMissingOrDamagedIsNamed) {
    Result<Model> model = importModel(bonedTriangle("gone.png"));
    ASSERT_FALSE(model);
    EXPECT_NE(model.error().message.find("gone.png"), std::string::npos) << model.error().message;
    EXPECT_NE(model.error().message.find("no such file"), std::string::npos) << model.error().message;
    write("bad.png", "this is text");
    model = importModel(bonedTriangle("bad.png"));
    ASSERT_FALSE(model);
    EXPECT_NE(model.error().message.find("damaged"), std::string::npos) << model.error().message;
    EXPECT_EQ(model.error().message.find('\n'), std::string::npos);
    EXPECT_FALSE(loadImage(folder_.string()));
    EXPECT_FALSE(loadImage(write("empty.png", "")));
    EXPECT_FALSE(importModel(write("none.glb", "nothing")));
}

TEST_F(SceneModel, aPlainMeshIsAModelOfOnePart) {
    Result<Model> model = importModel(std::string(RIVULET_SOURCE_DIR) + "/assets/meshes/spot.obj");
    ASSERT_TRUE(model) << model.error().message;
    ASSERT_EQ(model->parts.size(), 1U);
    EXPECT_TRUE(model->parts[0].morphs.empty());
    EXPECT_TRUE(model->parts[0].grips.empty());
    EXPECT_EQ(model->parts[0].mesh.uvs.size(), model->parts[0].mesh.positions.size());
}

}  // namespace
}  // namespace rivulet::scene_model_test
