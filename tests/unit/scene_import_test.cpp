// importMesh: every file is read correctly, or refused with a message that names it.
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <fstream>

#include "engine/scene/import_model.h"

namespace rivulet::scene_import_test {
namespace {

class SceneImport : public ::testing::Test {
  protected:
    void SetUp() override {
        folder_ = std::filesystem::temp_directory_path() /
                  ("rivulet_import_" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()) + "_" +
                   std::to_string(::getpid()));
        std::filesystem::create_directories(folder_);
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }
    std::string write(const std::string& name, const std::string& text) {
        std::string path = (folder_ / name).string();
        std::ofstream(path, std::ios::binary) << text;
        return path;
    }
    // One sentence, naming the file, holding `words`, and nothing printed to stderr or stdout.
    static void refused(const std::string& path, const std::string& words) {
        ::testing::internal::CaptureStdout();
        ::testing::internal::CaptureStderr();
        Result<Mesh> mesh = importMesh(path);
        EXPECT_EQ(::testing::internal::GetCapturedStdout(), "");
        EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
        ASSERT_FALSE(mesh) << path;
        EXPECT_NE(mesh.error().message.find(path), std::string::npos) << mesh.error().message;
        EXPECT_NE(mesh.error().message.find(words), std::string::npos) << mesh.error().message;
        EXPECT_EQ(mesh.error().message.find('\n'), std::string::npos) << mesh.error().message;
        EXPECT_EQ(mesh.error().fault, Fault::badInput);
    }
    std::filesystem::path folder_;
};

const char* const kCube =
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
    "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 3 4 8 7\nf 2 3 7 6\nf 1 5 8 4\n";

double signedVolume(const Mesh& mesh) {
    double six = 0;
    for (size_t t = 0; t + 2 < mesh.indices.size(); t += 3)
        six +=
            glm::dot(mesh.positions[mesh.indices[t]], glm::cross(mesh.positions[mesh.indices[t + 1]], mesh.positions[mesh.indices[t + 2]]));
    return six / 6;
}

TEST_F(SceneImport, quadsBecomeTrianglesThatKeepVolumeAndGetSmoothOutwardNormals) {
    Result<Mesh> mesh = importMesh(write("cube.obj", kCube));
    ASSERT_TRUE(mesh) << mesh.error().message;
    EXPECT_EQ(mesh->view().triangleCount(), 12U);
    EXPECT_NEAR(signedVolume(*mesh), 1.0, 1e-6);
    ASSERT_EQ(mesh->normals.size(), mesh->positions.size());
    for (size_t i = 0; i < mesh->positions.size();
         ++i) {  // a cube's smooth normals point from its centre, roughly (its diagonals weigh twice)
        EXPECT_NEAR(glm::length(mesh->normals[i]), 1.0F, 1e-5F);
        EXPECT_GT(glm::dot(mesh->normals[i], glm::normalize(mesh->positions[i] - vec3(0.5F))), 0.8F);
    }
    Bounds b = mesh->bounds();
    EXPECT_EQ(b.min, vec3(0.0F));
    EXPECT_EQ(b.max, vec3(1.0F));
}

TEST_F(SceneImport, glTFNodesAreMovedAndMerged) {
    // One triangle, used by two nodes: one moved by (10,0,0), one scaled by 2 under a parent moved by (0,5,0).
    std::string buffer = "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";  // (0,0,0) (1,0,0) (0,1,0)
    Result<Mesh> mesh = importMesh(write("two.gltf", R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,1]}],
        "nodes":[{"mesh":0,"translation":[10,0,0]},{"translation":[0,5,0],"children":[2]},{"mesh":0,"scale":[2,2,2]}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
        "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}],
        "bufferViews":[{"buffer":0,"byteLength":36}],
        "buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,)" +
                                                         buffer + R"("}]})"));
    ASSERT_TRUE(mesh) << mesh.error().message;
    EXPECT_EQ(mesh->view().triangleCount(), 2U);
    Bounds b = mesh->bounds();
    EXPECT_EQ(b.min, vec3(0, 0, 0));
    EXPECT_EQ(b.max, vec3(11, 7, 0));
}

TEST_F(SceneImport, plyAndStl) {
    Result<Mesh> ply =
        importMesh(write("t.ply",
                         "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                         "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n2 0 0\n0 2 0\n3 0 1 2\n"));
    ASSERT_TRUE(ply) << ply.error().message;
    EXPECT_EQ(ply->view().triangleCount(), 1U);
    EXPECT_EQ(ply->normals.at(0), vec3(0, 0, 1));
    Result<Mesh> stl = importMesh(write(
        "t.stl", "solid t\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid t\n"));
    ASSERT_TRUE(stl) << stl.error().message;
    EXPECT_EQ(stl->view().triangleCount(), 1U);
}

TEST_F(SceneImport, aMissingFileAFolderAnEmptyFileAndAnUnknownKindAreRefused) {
    refused((folder_ / "nothing.obj").string(), "there is no such file");
    refused(folder_.string(), "is a folder");
    refused(write("empty.obj", ""), "is an empty file");
    refused(write("notes.txt", "hello"), "of a kind that cannot be read");
    refused(write("broken.gltf", "{\"asset\": "), "cannot be read");
    refused(write("broken.ply", "ply\nformat ascii 1.0\nelement vertex 3\n"), "");
}

TEST_F(SceneImport, meshesWithoutTrianglesAreRefused) {
    refused(write("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n"), "no triangles");
    refused(write("line.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nl 1 2\n"), "no triangles");
    refused(write("comment.obj", "# nothing here\n"), "");
}

TEST_F(SceneImport, verticesThatAreNotFiniteAreCounted) {
    refused(write("nan.obj", std::string("v nan 0 0\nv 0 inf 0\n") + "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 3 4 5\nf 1 2 3\nf 1 3 4\n"),
            "has 2 vertices with NaN or infinite");
    refused(write("big.obj", "v 0 0 0\nv 1e39 0 0\nv 0 1 0\nf 1 2 3\n"), "has 1 vertex with NaN or infinite");
    refused(write("nan.ply",
                  "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                  "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 nan 0\n2 0 0\n0 2 0\n3 0 1 2\n"),
            "has 1 vertex with NaN or infinite");
}

TEST_F(SceneImport, anIndexOutOfRangeIsRefused) {
    refused(write("far.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n"), "index");
    refused(write("far.ply",
                  "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                  "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n2 0 0\n0 2 0\n3 0 1 7\n"),
            "index");
}

}  // namespace
}  // namespace rivulet::scene_import_test
