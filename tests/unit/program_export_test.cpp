// `rivulet export`: the meshes it leaves behind, and how it ends when things go wrong.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <filesystem>

#include "engine/core/file.h"
#include "engine/scene/import_model.h"
#include "tests/unit/mesh_volume.h"
#include "tests/unit/program_runner.h"

namespace rivulet::testing::program_export_test {
namespace {

constexpr double kBlock = 0.16 * 0.16 * 0.12;  // m^3

// A block falls for six frames and is still whole.
TEST(ProgramExport, WritesASurfaceEveryNthFrame) {
    for (const char* format : {"obj", "ply"}) {
        Scratch scratch;
        scratch.file("s.json", R"({"name": "small", "fluid": {"spacing": 0.02, "box": {"min": [0, 0, 0], "max": [0.4, 0.4, 0.4]},
            "blocks": [{"min": [0.06, 0.1, 0.06], "max": [0.22, 0.26, 0.18]}]}})");
        const Outcome outcome =
            runProgram({"export", "s.json", "--surface", format, "--every", "3", "--seconds", "0.1", "--out", "meshes", "--backend", "cpu"},
                       in(scratch));
        ASSERT_EQ(outcome.code, 0) << outcome.err;
        EXPECT_EQ(outcome.err, "");
        const std::string zero = std::string("meshes/small_0000.") + format, three = std::string("meshes/small_0003.") + format;
        EXPECT_EQ(scratch.contents(), (std::vector<std::string>{"meshes", zero, three, "s.json"}));
        double low = 1;
        for (const std::string& file : {zero, three}) {
            const Result<Mesh> mesh = importMesh((scratch.path() / file).string());
            ASSERT_TRUE(mesh) << mesh.error().message;
            EXPECT_NEAR(volumeOf(mesh->view()) / kBlock, 1, 0.08);  // its edges are round
            EXPECT_LT(mesh->bounds().min.y, low) << "it falls";
            low = mesh->bounds().min.y;
        }
    }
}

TEST(ProgramExport, ErrorsNameTheirCause) {
    Scratch scratch;
    scratch.file("s.json", smallScene());
    scratch.file("file", "not a folder");
    expectRefusal(runProgram({"export", "s.json"}, in(scratch)), 2, "--surface obj or ply");
    expectRefusal(runProgram({"export", "s.json", "--surface", "objj"}, in(scratch)), 2, "did you mean 'obj'");
    expectRefusal(runProgram({"export", "s.json", "--surface", "stl"}, in(scratch)), 2, "use one of: obj, ply");
    expectRefusal(runProgram({"export", "none.json", "--surface", "obj"}, in(scratch)), 2, "none.json");
    expectRefusal(runProgram({"export", "s.json", "--surface", "obj", "--every", "0"}, in(scratch)), 2, "--every");
    expectRefusal(runProgram({"export", "s.json", "--surface", "obj", "--out", "file/meshes"}, in(scratch)), 1, "file/meshes");
    expectRefusal(runProgram({"export", "s.json", "--surface", "obj", "--seconds", "3600", "--set", "timeScale=1e-4"}, in(scratch)), 2,
                  "--seconds: 3600 s at timeScale 0.0001 need 2.16e+09 frames");
    scratch.file("dry.json", R"({"name": "dry", "fluid": {"spacing": 0.02, "box": {"min": [0, 0, 0], "max": [0.4, 0.4, 0.4]}}})");
    const Outcome dry = runProgram({"export", "dry.json", "--surface", "obj", "--seconds", "0.05", "--backend", "cpu"}, in(scratch));
    EXPECT_EQ(dry.code, 1);
    EXPECT_NE(dry.err.find("dry has no particles in its first 0.05 s"), std::string::npos) << dry.err;
}

// Data sets: what they hold is tested by embed.data.
TEST(ProgramExport, ADataSetIsWholeOrNotThere) {
    const Scratch scratch;
    scratch.file("s.json", smallScene());
    ASSERT_EQ(runProgram({"run", "s.json", "--no-render", "--frames", "8", "--backend", "cpu", "--record", "s.rrec"}, in(scratch)).code, 0);
    const auto exported = [&](std::vector<std::string> words, const RunOptions& options) {
        words.insert(words.begin(), {"export", "s.rrec", "--format", "zarr", "--out", "sets"});
        return runProgram(words, options);
    };
    const Outcome whole = exported({}, in(scratch));
    ASSERT_EQ(whole.code, 0) << whole.err;
    EXPECT_EQ(whole.err, "");
    EXPECT_TRUE(std::filesystem::exists(scratch.path() / "sets/s.zarr/position/7.0.0"));
    expectRefusal(exported({}, in(scratch)), 1, "sets/s.zarr exists; remove it");
    std::filesystem::remove_all(scratch.path() / "sets");
    std::filesystem::create_directory(scratch.path() / "sets");
    scratch.file("sets/s.zarr", "a file");
    expectRefusal(exported({}, in(scratch)), 1, "sets/s.zarr exists; remove it");
    EXPECT_EQ(scratch.text("sets/s.zarr"), "a file");
    std::filesystem::remove_all(scratch.path() / "sets");

    RunOptions full = in(scratch);  // as on a full disk: a file may not be longer than this
    full.before = [] {
        std::signal(SIGXFSZ, SIG_IGN);
        const rlimit most = {2000, 2000};
        ::setrlimit(RLIMIT_FSIZE, &most);
    };
    expectRefusal(exported({}, full), 1, "sets/s.zarr/");
    expectRefusal(exported({"--set", "fluid.viscosity=1"}, in(scratch)), 2, "not simulated again; leave --set out");
    expectRefusal(exported({"--up", "z"}, in(scratch)), 2, "leave --up out");
    expectRefusal(runProgram({"export", "s.rrec", "--format", "ply", "--out", "sets"}, in(scratch)), 2, "as hdf5 or zarr; for ply export");
    std::filesystem::resize_file(scratch.path() / "s.rrec", std::filesystem::file_size(scratch.path() / "s.rrec") / 2);
    const Outcome cut = exported({}, in(scratch));
    ASSERT_EQ(cut.code, 0) << cut.err;
    EXPECT_NE(cut.err.find("s.rrec has no end: it is cut off or damaged at byte"), std::string::npos) << cut.err;
    EXPECT_NE(cut.err.find("only its whole frames, 0 to"), std::string::npos) << "true where frames are written, too: " << cut.err;
    const Result<std::string> attributes = readFile((scratch.path() / "sets/s.zarr/.zattrs").string());
    ASSERT_TRUE(attributes) << attributes.error().message;
    EXPECT_NE(attributes->find("\"incomplete\""), std::string::npos);
    std::filesystem::remove_all(scratch.path() / "sets");
    std::filesystem::resize_file(scratch.path() / "s.rrec", 20);
    expectRefusal(exported({}, in(scratch)), 2, "s.rrec: it is cut off after 20 bytes");
    EXPECT_TRUE(!std::filesystem::exists(scratch.path() / "sets") || std::filesystem::is_empty(scratch.path() / "sets"))
        << "nothing is left";
}

// Water that grows from 100 to 4,000 particles, of a scene and of its recording.
TEST(ProgramExport, AChunkHoldsOneFrameWhereWaterGrows) {
    const Scratch scratch;
    scratch.file("tap.json", R"({"name": "tap", "fluid": {"spacing": 0.01, "box": {"max": [0.6, 0.4, 0.3]}}, "emitters": [
        {"position": [0.3, 0.3, 0.15], "direction": [0, -1, 0], "speed": 2, "litresPerSecond": 40, "radius": 0.1}]})");
    ASSERT_EQ(runProgram({"run", "tap.json", "--no-render", "--frames", "8", "--backend", "cpu", "--record", "tap.rrec"}, in(scratch)).code,
              0);
    for (const char* source : {"tap.json", "tap.rrec"}) {
        std::filesystem::remove_all(scratch.path() / "sets");
        std::vector<std::string> words = {"export", source, "--format", "zarr", "--out", "sets"};
        if (source == std::string("tap.json")) words.insert(words.end(), {"--seconds", "0.133334", "--backend", "cpu"});
        const Outcome outcome = runProgram(words, in(scratch));
        ASSERT_EQ(outcome.code, 0) << outcome.err;
        EXPECT_TRUE(std::filesystem::exists(scratch.path() / "sets/tap.zarr/position/7.0.0"));
        EXPECT_FALSE(std::filesystem::exists(scratch.path() / "sets/tap.zarr/position/7.1.0")) << source;
        const std::string shape = scratch.text("sets/tap.zarr/position/.zarray");
        EXPECT_GT(std::stoul(shape.substr(shape.find("[8, ") + 4)), 2000U) << shape;
    }
}

}  // namespace
}  // namespace rivulet::testing::program_export_test
