// Models are read in a process of their own: nothing that it does, and nothing that a file holds, ends or blocks this one.
#include "engine/scene/import_process.h"

#include <gtest/gtest.h>

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <fstream>

#include "engine/scene/import_model.h"
#include "engine/scene/load_image.h"
#include "engine/scene/model_wire.h"
#include "tests/unit/program_runner.h"

namespace rivulet::testing::import_process_test {
namespace {

namespace fs = std::filesystem;

size_t openDescriptors() {
    size_t count = 0;
    for (const auto& entry : fs::directory_iterator("/proc/self/fd")) count += entry.is_symlink() ? 1 : 0;
    return count;
}

// A shell script in the place of rivulet_import.
class ImportProcess : public ::testing::Test {
  protected:
    std::string fake(const std::string& script) const {
        const std::string path = scratch_.file("reader.sh", "#!/bin/sh\n" + script + "\n");
        EXPECT_EQ(::chmod(path.c_str(), 0755), 0);
        return path;
    }
    Error errorOf(const std::string& program, const ImportLimits& limits = {}) const {
        const size_t before = openDescriptors();
        const Result<Model> model = importThrough(program, "model", "some/ship.obj", limits);
        EXPECT_EQ(openDescriptors(), before);
        EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1) << "a child is left";
        EXPECT_EQ(errno, ECHILD);
        EXPECT_FALSE(model);
        return model ? Error() : model.error();
    }
    void refused(const std::string& script, const std::string& mentions, const ImportLimits& limits = {}) const {
        const Error error = errorOf(fake(script), limits);
        EXPECT_TRUE(error.message.starts_with("the mesh 'some/ship.obj' ")) << script << ": " << error.message;
        EXPECT_NE(error.message.find(mentions), std::string::npos) << script << ": " << error.message;
        EXPECT_EQ(error.message.find('\n'), std::string::npos);
        EXPECT_EQ(error.fault, Fault::badInput);
    }
    Scratch scratch_;
};

TEST_F(ImportProcess, AReaderThatEndsWithoutAnAnswerIsOneSentence) {
    refused("exit 0", "answer of its reader is damaged");
    refused("exit 1", "its reader crashed");
    refused("kill -SEGV $$", "its reader crashed");
    refused("kill -ABRT $$", "its reader crashed");
    refused("kill -KILL $$", "was killed");
    refused("kill -XCPU $$", "takes too long");
    refused("kill -INT $$", "was interrupted");
}

// Decoders of pictures crash as well.
TEST_F(ImportProcess, PicturesAreReadThere) {
    for (const char* script : {"exit 1", "kill -SEGV $$", "kill -XCPU $$", "head -c 100000 /dev/urandom"}) {
        const Result<Model> model = importThrough(fake(script), "image", "some/mask.jpg");
        ASSERT_FALSE(model);
        EXPECT_TRUE(model.error().message.starts_with("the image 'some/mask.jpg' ")) << model.error().message;
    }
    const std::string mask = std::string(RIVULET_SOURCE_DIR) + "/assets/meshes/head/skin_regions.png";
    const Result<std::shared_ptr<const Image>> read = importImage(mask);
    ASSERT_TRUE(read) << read.error().message;
    const Result<Image> here = loadImage(mask);
    ASSERT_TRUE(here);
    EXPECT_EQ((*read)->width, here->width);
    EXPECT_EQ((*read)->height, here->height);
    EXPECT_TRUE((*read)->rgba == here->rgba);
    for (const std::string& path :
         {scratch_.file("none.png"), scratch_.file("text.png", "text"), scratch_.file("empty.jpg", ""), scratch_.path().string()}) {
        const Result<std::shared_ptr<const Image>> refused = importImage(path);
        const Result<Image> too = loadImage(path);
        ASSERT_FALSE(refused);
        ASSERT_FALSE(too);
        EXPECT_EQ(refused.error().message, too.error().message);
        EXPECT_EQ(refused.error().fault, Fault::badInput);
    }
}

TEST_F(ImportProcess, AReaderThatAnswersAnythingElseIsOneSentence) {
    refused("head -c 100000 /dev/urandom", "answer of its reader is damaged");
    refused("printf RVMODEL1; head -c 100000 /dev/zero", "answer of its reader is damaged");
    refused("printf RVMODEL1; head -c 100000 /dev/zero | tr '\\0' '\\377'", "answer of its reader is damaged");
    refused("printf RVFAULT1; head -c 100000 /dev/zero | tr '\\0' '\\377'", "answer of its reader is damaged");
    ImportLimits limits;
    limits.answer = size_t{1} << 20U;
    refused("exec cat /dev/zero", "takes more than", limits);
    // The answer of a reader that was taken over: a fault with commands for the terminal.
    std::string bytes;
    ASSERT_TRUE(sendFault("is \x1B[2J gone\n", [&bytes](std::span<const std::byte> more) {
        bytes.append(reinterpret_cast<const char*>(more.data()), more.size());
        return true;
    }));
    const std::string answer = scratch_.file("answer", bytes);
    refused("cat " + answer, "is ?[2J gone?");
    refused("cat " + answer + "; exit 1", "its reader crashed");
}

TEST_F(ImportProcess, AReaderThatDoesNotEndIsEnded) {
    ImportLimits limits;
    limits.wall = std::chrono::milliseconds(300);
    refused("exec sleep 1000", "takes too long", limits);
    refused("printf RVMODEL1; exec sleep 1000", "takes too long", limits);
    refused("exec >&-; exec sleep 1000", "takes too long", limits);
    refused("trap '' TERM INT HUP; while :; do :; done", "takes too long", limits);
}

TEST_F(ImportProcess, AReaderThatIsMissingIsNamed) {
    for (const std::string& program : {std::string(), scratch_.file("none"), scratch_.file("not_executable", "text")}) {
        const Error error = errorOf(program);
        EXPECT_EQ(error.fault, Fault::failed);
        EXPECT_NE(error.message.find(program.empty() ? "rivulet_import" : program), std::string::npos) << error.message;
        EXPECT_NE(error.message.find("install"), std::string::npos) << error.message;
    }
}

TEST_F(ImportProcess, TheReaderInheritsNoOpenFile) {
    const int secret = ::open(scratch_.file("secret", "text").c_str(), O_RDONLY);  // without O_CLOEXEC
    ASSERT_GE(secret, 0);
    const std::string list = scratch_.file("list");
    const Error error = errorOf(fake("for f in /proc/$$/fd/*; do readlink $f; done >" + list + "; echo to the terminal >&2; exit 1"));
    ::close(secret);
    std::ifstream file(list);
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    EXPECT_NE(text.find("/dev/null"), std::string::npos) << text;
    EXPECT_EQ(text.find("secret"), std::string::npos) << text;
}

TEST_F(ImportProcess, TheReaderReceivesTheFileAndItsLimits) {
    const std::string list = scratch_.file("list");
    ImportLimits limits;
    limits.memory = 123456789;
    limits.seconds = 7;
    (void)errorOf(fake("printf '%s|' \"$@\" >" + list), limits);
    std::ifstream file(list);
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    EXPECT_EQ(text, "model|some/ship.obj|123456789|7|");
}

// With descriptors 0 to 2 closed, the pipe takes their numbers.
TEST_F(ImportProcess, ClosedStandardFilesDoNotMatter) {
    const std::string mesh = std::string(RIVULET_SOURCE_DIR) + "/assets/meshes/plate.obj";
    for (const std::vector<int>& closed : {std::vector<int>{0, 1, 2}, {1}, {0}, {2}, {0, 1}}) {
        const pid_t child = ::fork();
        if (child == 0) {
            for (const int fd : closed) ::close(fd);
            ::_exit(importThrough(importProgram(), "mesh", mesh) ? 0 : 1);
        }
        int status = 0;
        EXPECT_EQ(::waitpid(child, &status, 0), child);
        EXPECT_EQ(status, 0) << closed[0];
    }
}

// Files that crash, exhaust or block assimp 5.2, or that name files which are none of theirs.
class HostileMesh : public ::testing::Test {
  protected:
    static void refused(const std::string& path, const std::string& mentions) {
        SCOPED_TRACE(path);
        ::testing::internal::CaptureStdout();
        ::testing::internal::CaptureStderr();
        const Result<Mesh> mesh = importMesh(path);
        const Result<Model> model = importModel(path);
        EXPECT_EQ(::testing::internal::GetCapturedStdout(), "");
        EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
        ASSERT_FALSE(model);
        for (const Error& error : {mesh ? model.error() : mesh.error(), model.error()}) {
            EXPECT_TRUE(error.message.starts_with("the mesh '" + path + "' ")) << error.message;
            EXPECT_NE(error.message.find(mentions), std::string::npos) << error.message;
            EXPECT_EQ(error.message.find('\n'), std::string::npos);
            EXPECT_LE(error.message.size(), 500U);
            EXPECT_EQ(error.fault, Fault::badInput);
        }
    }
    // A triangle whose numbers are in the buffer `uri`, and whose material has the texture `image`.
    static std::string gltf(const std::string& uri, const std::string& image = {}) {
        const std::string texture = R"("materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}],"textures":[{"source":0}],)";
        return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)" +
               (image.empty() ? "" : texture + R"("images":[{"uri":")" + image + R"("}],)") +
               R"("meshes":[{"primitives":[{"attributes":{"POSITION":0})" + (image.empty() ? "" : R"(,"material":0)") +
               R"(}]}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}],
                "bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36,"uri":")" +
               uri + R"("}]})";
    }
    static std::string triangle() {
        const float corners[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
        return {reinterpret_cast<const char*>(corners), sizeof corners};
    }
    std::string file(const std::string& name, const std::string& text) const {
        fs::create_directories((scratch_.path() / name).parent_path());
        return scratch_.file(name, text);
    }
    Scratch scratch_;
};

const char* const kData = "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";

TEST_F(HostileMesh, NodesNestedDeeplyAreNotACrash) {
    std::string nodes;
    constexpr int kNodes = 60000;
    for (int k = 1; k < kNodes; ++k) nodes += R"({"children":[)" + std::to_string(k) + "]},";
    std::string text = gltf(kData);
    const std::string one = R"("nodes":[{"mesh":0}])";
    text.replace(text.find(one), one.size(), R"("nodes":[)" + nodes + R"({"mesh":0}])");
    refused(file("deep.gltf", text), "cannot be read");
}

TEST_F(HostileMesh, ACountIsNoReasonToAllocate) {
    refused(file("count.ply",
                 "ply\nformat binary_little_endian 1.0\nelement vertex 1000000000\nproperty float x\nproperty float y\nproperty float z\n"
                 "element face 1\nproperty list uchar int vertex_indices\nend_header\n"),
            "");
}

TEST_F(HostileMesh, AFaceOfVeryManyCornersIsNamed) {
    std::string text, face = "f";
    constexpr int kCorners = 200000;
    for (int k = 0; k < kCorners; ++k) {
        const double turn = 2 * kPiD * k / kCorners;
        text += "v " + std::to_string(std::cos(turn)) + " " + std::to_string(std::sin(turn)) + " 0\n";
        face += " " + std::to_string(k + 1);
    }
    refused(file("disc.obj", text + face + "\n"), "has a face of 200000 corners");
}

// RAW files of two objects, with colours and with textures: assimp 5.2 follows a wild pointer.
TEST_F(HostileMesh, RawFilesOfTwoObjectsAreNotACrash) {
    const std::string coloured = file("colour.raw",
                                      "One\n0.5 0.5 0.5 0 0 0 0 1 0 1 0 0\n0.1 0 0 0 0 3 0 1 3 1 0 3\n"
                                      "Two\n0 1 0 0 3 0 0 4 0 1 3 0\n0 1 0 3 3 0 4 3 1 3 3");
    const std::string textured = file("texture.raw",
                                      "One\n0 0 0 0 1 0 1 0 0 a.png\n0 0 3 0 1 3 1 0 3 b.png\n"
                                      "Two\n0 3 0 0 4 0 1 3 0 a.png\n0 3 3 0 4 3 1 3 3 c.png");
    for (const std::string& path : {coloured, textured}) {
        const Result<Mesh> mesh = importMesh(path);
        if (!mesh) EXPECT_TRUE(mesh.error().message.starts_with("the mesh '" + path + "' ")) << mesh.error().message;
    }
}

TEST_F(HostileMesh, FilesOutsideTheFolderAreRefused) {
    const std::string outside = file("outside.bin", triangle());
    (void)file("outside.mtl", "newmtl m\nKd 1 0 0\n");
    fs::copy_file(std::string(RIVULET_SOURCE_DIR) + "/assets/pictures/falling_cube.jpg", scratch_.path() / "outside.jpg");
    const char* const refusal = "which is outside its folder";
    refused(file("model/up.gltf", gltf("../outside.bin")), refusal);
    refused(file("model/up_and_down.gltf", gltf("../model/../outside.bin")), refusal);
    refused(file("model/passwords.gltf", gltf("../../../../../../../../etc/passwd")), refusal);
    refused(file("model/texture.gltf", gltf(kData, "../outside.jpg")), refusal);
    refused(file("model/absolute_texture.gltf", gltf(kData, outside)), refusal);
    refused(file("model/material.obj", "mtllib ../outside.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n"), refusal);
    fs::create_symlink(outside, scratch_.path() / "model/link.bin");
    refused(file("model/link.gltf", gltf("link.bin")), refusal);
    fs::create_directory_symlink(scratch_.path(), scratch_.path() / "model/folder");
    refused(file("model/folder.gltf", gltf("folder/outside.bin")), refusal);
}

TEST_F(HostileMesh, PipesAndDevicesAreRefused) {
    fs::create_directories(scratch_.path() / "model");
    ASSERT_EQ(::mkfifo((scratch_.path() / "model/pipe.bin").c_str(), 0600), 0);
    ASSERT_EQ(::mkfifo((scratch_.path() / "model/pipe.png").c_str(), 0600), 0);
    ASSERT_EQ(::mkfifo((scratch_.path() / "model/pipe.gltf").c_str(), 0600), 0);
    refused(file("model/a.gltf", gltf("pipe.bin")), "is not a plain file");
    refused(file("model/b.gltf", gltf(kData, "pipe.png")), "is not a plain file");
    fs::create_directory(scratch_.path() / "model/data");
    refused(file("model/c.gltf", gltf("data")), "is not a plain file");
    refused((scratch_.path() / "model/pipe.gltf").string(), "is not a plain file");
    refused("/dev/zero", "is not a plain file");
}

// The rule refuses nothing that an honest model does.
TEST_F(HostileMesh, FilesInTheFolderAreRead) {
    (void)file("model/data/t.bin", triangle());
    fs::copy_file(std::string(RIVULET_SOURCE_DIR) + "/assets/pictures/falling_cube.jpg", scratch_.path() / "model/data/t.jpg");
    fs::create_symlink("data/t.bin", scratch_.path() / "model/link.bin");
    for (const char* uri : {"data/t.bin", "./data/../data/t.bin", "link.bin", "../model/data/t.bin"}) {
        const Result<Model> model = importModel(file("model/a.gltf", gltf(uri, "data/t.jpg")));
        ASSERT_TRUE(model) << uri << ": " << model.error().message;
        EXPECT_EQ(model->parts.at(0).material.colour->width, 480) << uri;
    }
    // The model itself may be a link to another folder.
    fs::create_directories(scratch_.path() / "other");
    (void)file("model/self.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    fs::create_symlink(scratch_.path() / "model/self.obj", scratch_.path() / "other/linked.obj");
    EXPECT_TRUE(importMesh(scratch_.file("other/linked.obj")));
}

TEST_F(HostileMesh, AbsurdNumbersAreRefused) {
    refused(file("far.obj", "v 0 0 0\nv 1e16 0 0\nv 0 1 0\nf 1 2 3\n"), "has 1 vertex with coordinates above 1e+15");
    std::string text = gltf(kData);
    const std::string node = R"({"mesh":0})";
    text.replace(text.find(node), node.size(), R"({"mesh":0,"scale":[1e30,1,1]})");
    refused(file("scaled.gltf", text), "that is not finite or is above 1e15");
}

}  // namespace
}  // namespace rivulet::testing::import_process_test
