// `rivulet voxelize`: its output files, its messages, and its exit status after errors.
#include <gtest/gtest.h>
#include <json/json.h>
#include <signal.h>

#include <fstream>
#include <sstream>

#include "fluid/voxel/voxel_file.h"
#include "tests/unit/program_runner.h"
#include "tests/unit/voxel_test_meshes.h"

namespace rivulet::testing::program_voxelize_test {
namespace {

namespace fs = std::filesystem;

std::string objOf(const test::Mesh& mesh) {
    std::ostringstream out;
    out.precision(9);
    for (const vec3& p : mesh.positions) out << "v " << p.x << " " << p.y << " " << p.z << "\n";
    for (size_t k = 0; k < mesh.indices.size(); k += 3)
        out << "f " << mesh.indices[k] + 1 << " " << mesh.indices[k + 1] + 1 << " " << mesh.indices[k + 2] + 1 << "\n";
    return out.str();
}

test::Mesh joined(test::Mesh a, const test::Mesh& b) {
    const auto first = static_cast<uint32_t>(a.positions.size());
    a.positions.insert(a.positions.end(), b.positions.begin(), b.positions.end());
    for (uint32_t index : b.indices) a.indices.push_back(first + index);
    return a;
}

Json::Value readJson(const fs::path& path) {
    std::ifstream stream(path);
    Json::Value value;
    EXPECT_TRUE(Json::parseFromStream(Json::CharReaderBuilder(), stream, &value, nullptr)) << path;
    return value;
}

// Two boxes apart, 2 x 1 x 1 and 1 x 1 x 1, in one mesh 4 long: two materials of known volume.
TEST(ProgramVoxelize, FileFiguresAndPictures) {
    Scratch scratch;
    const std::string mesh =
        scratch.file("boxes.obj", objOf(joined(test::makeBox(vec3(0), vec3(2, 1, 1)), test::makeBox(vec3(3, 0, 0), vec3(4, 1, 1)))));
    const Outcome outcome = runProgram({"voxelize", "boxes.obj", "--resolution", "100", "--backend", "cpu", "--labels", "--band", "--stats",
                                        "s.json", "--slices", "slices.png", "--picture", "picture.png"},
                                       in(scratch));
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(outcome.err, "");
    EXPECT_EQ(scratch.contents(), (std::vector<std::string>{"boxes.obj", "boxes.rvox", "picture.png", "s.json", "slices.png"}));
    for (const char* word : {"boxes.rvox", "100 x 25 x 25", "material 0", "material 1", "memory", "time"})
        EXPECT_NE(outcome.out.find(word), std::string::npos) << word << " is not in: " << outcome.out;

    const Json::Value stats = readJson(scratch.path() / "s.json");
    EXPECT_EQ(stats.getMemberNames(), (std::vector<std::string>{"badEdges", "bytes", "materials", "mesh", "mode", "ms", "outside",
                                                                "resolution", "surface", "voxel", "watertight"}));
    EXPECT_EQ(stats["mesh"].asString(), "boxes.obj");
    EXPECT_EQ(stats["mode"].asString(), "solid");
    ASSERT_EQ(stats["resolution"].size(), 3U);
    EXPECT_EQ(stats["resolution"][0].asInt(), 100);
    EXPECT_NEAR(stats["voxel"].asDouble(), 0.04, 1e-6);
    EXPECT_TRUE(stats["watertight"].asBool());
    EXPECT_EQ(stats["badEdges"].asInt(), 0);
    EXPECT_EQ(stats["bytes"].asUInt64(), fs::file_size(scratch.path() / "boxes.rvox"));
    EXPECT_GT(stats["ms"].asDouble(), 0);
    uint64_t voxels = stats["surface"].asUInt64() + stats["outside"].asUInt64();
    ASSERT_EQ(stats["materials"].size(), 2U);
    const double inside[] = {2, 1};
    for (unsigned k = 0; k < 2; ++k) {
        const Json::Value& m = stats["materials"][k];
        EXPECT_EQ(m.getMemberNames(), (std::vector<std::string>{"id", "volume", "voxels"}));
        EXPECT_EQ(m["id"].asUInt(), k);
        EXPECT_NEAR(m["volume"].asDouble(), m["voxels"].asDouble() * 0.04 * 0.04 * 0.04, 1e-6);
        // Less than the box by the surface's voxels, which are at most two thick.
        EXPECT_LT(m["volume"].asDouble(), inside[k]);
        EXPECT_GT(m["volume"].asDouble(), (inside[k] - 0.16) * 0.84 * 0.84);
        voxels += m["voxels"].asUInt64();
    }
    EXPECT_EQ(voxels, 100U * 25 * 25);

    const Result<VoxelFile> file = readVoxelFile((scratch.path() / "boxes.rvox").string());
    ASSERT_TRUE(file) << file.error().message;
    EXPECT_EQ(file->mode, VoxelMode::solid);
    ASSERT_TRUE(file->labels && file->band);
    EXPECT_EQ(file->labels->surface, stats["surface"].asUInt64());
    size_t set = 0;
    for (uint8_t byte : file->bits.bits) set += static_cast<size_t>(__builtin_popcount(byte));
    EXPECT_EQ(set, file->bits.count() - stats["outside"].asUInt64());
    // The middle of the gap between the boxes is half a unit from either: beyond the band. The middle of a wall is at it.
    EXPECT_NEAR(file->band->band, 0.2, 1e-3);
    const auto distanceAt = [&](int x, int y, int z) {
        return file->band->distance[(static_cast<size_t>(z) * 26 + static_cast<size_t>(y)) * 101 + static_cast<size_t>(x)];
    };
    EXPECT_EQ(distanceAt(62, 12, 12), file->band->band);
    EXPECT_NEAR(distanceAt(50, 12, 12), 0, 1e-5);
    EXPECT_NEAR(distanceAt(53, 12, 12), 0.12, 1e-5);
}

TEST(ProgramVoxelize, ModesAndDefaults) {
    Scratch scratch;
    scratch.file("ball.obj", objOf(test::makeSphere(vec3(0), 1, 12)));
    const auto statsOf = [&](std::vector<std::string> more) {
        std::vector<std::string> words = {"voxelize", "ball.obj", "--backend", "cpu", "--stats", "s.json"};
        words.insert(words.end(), more.begin(), more.end());
        const Outcome outcome = runProgram(words, in(scratch));
        EXPECT_EQ(outcome.code, 0) << outcome.err;
        return readJson(scratch.path() / "s.json");
    };
    const Json::Value plain = statsOf({});
    EXPECT_EQ(plain["mode"].asString(), "solid");
    EXPECT_EQ(plain["resolution"][0].asInt(), 128);
    EXPECT_TRUE(fs::exists(scratch.path() / "ball.rvox"));
    Json::Value depth = statsOf({"--mode", "depth", "--resolution", "24"}),
                thesis = statsOf({"--mode", "depth", "--resolution", "24", "--thesis-order"});
    for (const char* key : {"surface", "outside", "materials", "bytes"}) EXPECT_EQ(depth[key], thesis[key]) << key;
    EXPECT_EQ(statsOf({"--mode", "surface", "--resolution", "24", "--out", "other.rvox"})["mode"].asString(), "surface");
    const Result<VoxelFile> file = readVoxelFile((scratch.path() / "other.rvox").string());
    ASSERT_TRUE(file) << file.error().message;
    EXPECT_FALSE(file->labels || file->band);
}

TEST(ProgramVoxelize, DefectsAreSaid) {
    Scratch scratch;
    test::Mesh open = test::makeBox(vec3(0), vec3(1));
    open.indices.resize(30);  // without one of its sides
    scratch.file("open.obj", objOf(open));
    const Outcome outcome =
        runProgram({"voxelize", "open.obj", "--resolution", "16", "--backend", "cpu", "--stats", "s.json"}, in(scratch));
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_TRUE(outcome.err.starts_with("rivulet: ")) << outcome.err;
    EXPECT_NE(outcome.err.find("boundary edges"), std::string::npos) << outcome.err;
    const Json::Value stats = readJson(scratch.path() / "s.json");
    EXPECT_FALSE(stats["watertight"].asBool());
    EXPECT_EQ(stats["badEdges"].asInt(), 4);
}

TEST(ProgramVoxelize, InvalidRequestsAreRefusedAndNothingIsWritten) {
    Scratch scratch;
    scratch.file("ball.obj", objOf(test::makeSphere(vec3(0), 1, 4)));
    scratch.file("blocker", "a file, not a folder");
    scratch.file("nothing.obj", "v 0 0 0\n");
    scratch.file("cut.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2\n");  // its end is missing
    const std::vector<std::string> before = scratch.contents();
    const auto with = [&](std::vector<std::string> more, const std::string& mesh = "ball.obj") {
        std::vector<std::string> words = {"voxelize", mesh, "--backend", "cpu"};
        words.insert(words.end(), more.begin(), more.end());
        return runProgram(words, in(scratch));
    };
    expectRefusal(runProgram({"voxelize"}), 2, "MESH");
    expectRefusal(with({}, "none.obj"), 2, "none.obj");
    expectRefusal(with({}, "nothing.obj"), 2, "nothing.obj");
    const Outcome cut = with({}, "cut.obj");
    expectRefusal(cut, 2, "cut.obj");
    EXPECT_EQ(cut.err.find("orphaned"), std::string::npos) << cut.err;
    expectRefusal(with({"--mode", "sold"}), 2, "did you mean 'solid'");
    expectRefusal(runProgram({"voxelize", "ball.obj", "--backend", "cpuu"}, in(scratch)), 2, "did you mean 'cpu'");
    expectRefusal(with({"--out", "x.png"}), 2, ".rvox");
    expectRefusal(with({"--slices", "x.jpg"}), 2, ".png");
    expectRefusal(with({"--slices", "x.png", "--picture", "x.png"}), 2, "x.png");
    expectRefusal(with({"--stats", "ball.obj"}), 2, "overwrite");
    expectRefusal(with({"--thesis-order"}), 2, "--mode depth");
    for (const char* resolution : {"0", "1", "-3", "5000", "many"}) expectRefusal(with({"--resolution", resolution}), 2, resolution);
    expectRefusal(with({"--resolution", "5000"}), 2, "GB");
    expectRefusal(with({"--out", "none/x.rvox"}), 1, "none/x.rvox");
    expectRefusal(with({"--picture", "blocker/x.png"}), 1, "blocker/x.png");
    for (const char* resolution : {"abc", "1.5", "1e3", "99999999999"})
        expectRefusal(with({"--resolution", resolution}), 2, "a whole number from 2 to 4096");
    fs::create_directory(scratch.path() / "folder.rvox");
    for (const char* option : {"--out", "--stats", "--slices", "--picture"}) expectRefusal(with({option, ""}), 2, option);
    expectRefusal(with({"--out", "folder.rvox"}), 2, "is a folder");
    fs::remove(scratch.path() / "folder.rvox");
    EXPECT_EQ(scratch.contents(), before);
}

// Twelve boxes: the figures of material 10 and 11 stand apart from their names, and small sizes are not 0.0 of something.
TEST(ProgramVoxelize, FiguresStandApart) {
    Scratch scratch;
    test::Mesh boxes;
    for (int k = 0; k < 12; ++k)
        boxes = joined(boxes, test::makeBox(vec3(2.0F * static_cast<float>(k), 0, 0), vec3(2.0F * static_cast<float>(k) + 1, 1, 1)));
    scratch.file("boxes.obj", objOf(boxes));
    const Outcome outcome = runProgram({"voxelize", "boxes.obj", "--resolution", "161", "--backend", "cpu"}, in(scratch));
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_NE(outcome.out.find("material 10 "), std::string::npos) << outcome.out;
    EXPECT_NE(outcome.out.find("material 11 "), std::string::npos) << outcome.out;
    EXPECT_EQ(outcome.out.find(" 0.0 "), std::string::npos) << outcome.out;
}

TEST(ProgramVoxelize, AMeshTooLargeForMemoryLeavesTheOldFile) {
    Scratch scratch;
    scratch.file("ball.obj", objOf(test::makeSphere(vec3(0), 1, 4)));
    const std::vector<std::string> words = {"voxelize", "ball.obj", "--backend", "cpu", "--resolution"};
    const auto at = [&](const char* resolution) {
        std::vector<std::string> all = words;
        all.emplace_back(resolution);
        return runProgram(all, in(scratch));
    };
    const auto content = [&] {
        std::ifstream stream(scratch.path() / "ball.rvox", std::ios::binary);
        return std::string(std::istreambuf_iterator<char>(stream), {});
    };
    ASSERT_EQ(at("20").code, 0);
    const std::string old = content();
    ASSERT_GT(old.size(), 100U);
    expectRefusal(at("4096"), 2, "A resolution of 4096 needs");
    EXPECT_TRUE(content() == old);
    EXPECT_EQ(scratch.contents(), (std::vector<std::string>{"ball.obj", "ball.rvox"}));
}

TEST(ProgramVoxelize, CtrlCLeavesNothing) {
    Scratch scratch;
    // Big enough to be at work for a while: the depth mode in the thesis's order.
    scratch.file("jumble.obj", objOf(test::makeJumble(3, 20000)));
    const std::vector<std::string> before = scratch.contents();
    RunOptions options = in(scratch);
    int rounds = 0;
    options.whileRunning = [&rounds](pid_t) { return ++rounds == 40 ? SIGINT : 0; };
    const Outcome outcome =
        runProgram({"voxelize", "jumble.obj", "--mode", "depth", "--thesis-order", "--resolution", "400", "--backend", "cpu"}, options);
    EXPECT_EQ(outcome.code, 130) << outcome.out << outcome.err;
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(scratch.contents(), before);
}

// Two programs that start at the same time, with one cache.
TEST(ProgramVoxelize, TwoRunsShareTheCacheOfFields) {
    Scratch scratch;
    scratch.file("ball.obj", objOf(test::makeSphere(vec3(0), 1, 24)));
    const std::string scene =
        scratch.file("s.json", smallScene(R"("colliders": [{"mesh": "ball.obj", "position": [0.2, 0, 0.2], "fitSize": 0.2}])"));
    RunOptions options = in(scratch);
    options.environment["XDG_CACHE_HOME"] = (scratch.path() / "cache").string();
    const std::string one = std::string(RIVULET_PROGRAM) + " run s.json --headless --no-render --backend cpu --frames 4 --out ";
    const Outcome outcome = runCommand({"sh", "-c", one + "a & " + one + "b; wait"}, options);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(outcome.err.find("cache"), std::string::npos) << outcome.err;
    EXPECT_EQ(outcome.err.find("kept"), std::string::npos) << outcome.err;
    size_t cached = 0;
    for (const auto& entry : fs::directory_iterator(scratch.path() / "cache/rivulet/voxels")) {
        EXPECT_EQ(entry.path().extension(), ".rvox");
        ++cached;
    }
    EXPECT_EQ(cached, 1U);
    const auto kinetic = [&](const char* folder) {
        return readJson(scratch.path() / folder / "stats.json")["energy"]["kinetic"].asDouble();
    };
    EXPECT_EQ(kinetic("a"), kinetic("b"));
    // A third reads what they wrote.
    ASSERT_EQ(runCommand({"sh", "-c", one + "c"}, options).code, 0);
    EXPECT_EQ(kinetic("a"), kinetic("c"));
}

}  // namespace
}  // namespace rivulet::testing::program_voxelize_test
