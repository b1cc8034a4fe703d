// `rivulet bench gpu`: compares the devices with the cpu, measures, and says so in JSON; a kernel that is wrong ends it with exit status 1.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <json/json.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <map>
#include <string>
#include <utility>

#include "engine/core/file.h"
#include "tests/unit/program_runner.h"

namespace rivulet::testing::program_gpu_test {
namespace {

Json::Value readJson(const std::string& path) {
    Json::Value value;
    std::ifstream file(path);
    std::string errors;
    EXPECT_TRUE(Json::parseFromStream(Json::CharReaderBuilder(), file, &value, &errors)) << path << ": " << errors;
    return value;
}

// Whether the machine has neither OpenGL nor OpenCL. With RIVULET_TEST_DEVICES that is a failure.
bool absent(const Outcome& outcome) {
    const bool neither = outcome.err.find("this machine has neither") != std::string::npos;
    if (neither) EXPECT_EQ(std::getenv("RIVULET_TEST_DEVICES"), nullptr) << outcome.err;
    return neither;
}

TEST(ProgramGpu, ComparesMeasuresAndPredicts) {
    const Scratch scratch;
    const std::string json = (scratch.path() / "gpu.json").string();
    const Outcome outcome = runProgram({"bench", "gpu", "--quick", "--seconds", "900", "--json", json});
    if (absent(outcome)) GTEST_SKIP() << outcome.err;
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_NE(outcome.out.find("computes the same water as the cpu; "), std::string::npos) << outcome.out;
    const Json::Value gpu = readJson(json)["gpu"];
    EXPECT_TRUE(gpu["correct"].asBool());
    EXPECT_GT(gpu["seconds"].asDouble(), 0);
    EXPECT_NE(outcome.out.find(gpu["sentence"].asString()), std::string::npos);
    ASSERT_GT(gpu["devices"].size(), 0U);
    EXPECT_TRUE(gpu["complete"].asBool());
    EXPECT_EQ(gpu["leftOut"].size(), 0U);
    // Per device: positions and velocities of each method and of one with forces, bodies in contact, drops on a skin; and a picture.
    size_t pictures = 0;
    for (const Json::Value& device : gpu["devices"]) pictures += device["backend"] == "gl" ? 1 : 0;
    EXPECT_EQ(gpu["checks"].size(), 12 * gpu["devices"].size() + pictures);
    for (const Json::Value& check : gpu["checks"]) {
        EXPECT_TRUE(check["pass"].asBool()) << check["what"].asString();
        EXPECT_LE(check["difference"].asDouble(), check["limit"].asDouble());
        EXPECT_FALSE(check["unit"].asString().empty());
    }
    for (const Json::Value& device : gpu["devices"]) {
        for (const char* key : {"backend", "name", "driver", "predictedFrom"}) EXPECT_TRUE(device[key].isString()) << key;
        for (const char* key : {"bytesPerSecond", "copiedBytes", "arithmetic", "integer", "special", "loads", "rounds", "dispatchMs"})
            EXPECT_GT(device["rates"][key].asDouble(), 0) << key;
        if (device["backend"] == "gl")
            for (const char* key : {"fragments", "filteredReads", "texelFetches"}) EXPECT_GT(device["rates"][key].asDouble(), 0) << key;
    }
    EXPECT_EQ(gpu["series"].size(), 3 * gpu["devices"].size());  // the smallest size of each method
    for (const Json::Value& row : gpu["series"]) {
        const std::string what = row["device"].asString() + ", " + row["method"].asString();
        for (const char* key : {"stepMs", "predictedStepMs", "frameMs", "predictedFrameMs", "particles"})
            EXPECT_GT(row[key].asDouble(), 0) << what << key;
        EXPECT_TRUE(row["passes"].isObject() && row["predictedPasses"].isObject()) << what;
        const bool drawn = row["device"] == "gl" && row["method"] == "pbf";  // OpenGL draws, whatever simulates
        for (const char* key : {"drawMs", "predictedDrawMs"}) EXPECT_EQ(row[key].asDouble() > 0, drawn) << what << key;
        // The model knows every kernel that takes a twentieth of the time.
        double whole = 0;
        for (const Json::Value& ms : row["passes"]) whole += ms.asDouble();
        for (const std::string& pass : row["passes"].getMemberNames())
            if (row["passes"][pass].asDouble() > 0.05 * whole) EXPECT_TRUE(row["predictedPasses"].isMember(pass)) << what << ": " << pass;
    }
}

// A copy of the shaders in which a test plants faults; options() makes the program use it.
class Shaders {
  public:
    explicit Shaders(const Scratch& scratch) : root_(scratch.path() / "root") {
        std::filesystem::create_directories(root_);
        std::filesystem::copy(RIVULET_SOURCE_DIR "/shaders", root_ / "shaders", std::filesystem::copy_options::recursive);
    }
    void replace(const std::string& file, const std::string& right, const std::string& wrong) const {
        const std::string path = (root_ / "shaders" / file).string();
        const Result<std::string> text = readFile(path);
        ASSERT_TRUE(text);
        const size_t at = text->find(right);
        ASSERT_NE(at, std::string::npos) << file;
        std::ofstream(path) << std::string(*text).replace(at, right.size(), wrong);
    }
    RunOptions options() const {
        RunOptions options;
        options.environment["RIVULET_SHADERS"] = root_.string();
        return options;
    }

  private:
    std::filesystem::path root_;
};

// Methods stay right: what is found is where bodies and drops have come to, and that a picture lacks the water.
TEST(ProgramGpu, WrongContactsDropsAndPicturesAreFoundWhereWaterIsRight) {
    const Scratch scratch;
    const Shaders shaders(scratch);
    shaders.replace("fluid/solids/advance_touching.kernel",
                    "c.normal = vec4(n, massAlong(n, toA, toB, c.turnA.xyz, c.turnB.xyz, inverse));", "c.normal = vec4(n, 0.0f);");
    shaders.replace("flow/walk.kernel", "w.v * PARAMS.dt);", "w.v * (1.5f * PARAMS.dt));");
    shaders.replace("screen_space/depth.frag", "void main() {", "void main() {\n    if (gl_FragCoord.x > 0.0) discard;");
    const Outcome outcome = runProgram({"bench", "gpu", "--quick", "--seconds", "900"}, shaders.options());
    if (absent(outcome)) GTEST_SKIP() << outcome.err;
    EXPECT_EQ(outcome.code, 1);
    EXPECT_NE(outcome.err.find("bodies in contact in water: largest difference of heights at rest: "), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find("drops on a skin: distance between their centres of mass after 30 steps: "), std::string::npos)
        << outcome.err;
    EXPECT_EQ(outcome.err.find("positions after"), std::string::npos) << outcome.err;
    if (outcome.out.find("(gl) does not compute") != std::string::npos)
        EXPECT_NE(outcome.err.find("gl: picture: pixels that particles cover and that show no water: "), std::string::npos) << outcome.err;
}

TEST(ProgramGpu, EndsInTimeAndNamesWhatIsLeftOut) {
    const Scratch scratch;
    const std::string json = (scratch.path() / "gpu.json").string();
    const Outcome outcome = runProgram({"bench", "gpu", "--quick", "--seconds", "1", "--json", json});
    if (absent(outcome)) GTEST_SKIP() << outcome.err;
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_NE(outcome.out.find("as far as there was time to compare; no size was measured"), std::string::npos) << outcome.out;
    EXPECT_NE(outcome.out.find("comparison of drops on a skin; "), std::string::npos) << outcome.out;
    EXPECT_NE(outcome.out.find("pbf with "), std::string::npos) << outcome.out;
    const Json::Value gpu = readJson(json)["gpu"];
    EXPECT_TRUE(gpu["complete"].asBool());
    EXPECT_EQ(gpu["series"].size(), 0U);
    EXPECT_GE(gpu["checks"].size(), 2U);
    EXPECT_GE(gpu["leftOut"].size(), 5U);
    ASSERT_EQ(gpu["devices"].size(), 1U);
    EXPECT_FALSE(gpu["devices"][0]["name"].asString().empty());
}

// Names of devices and drivers are in the file from the beginning: a driver may end the program in the first comparison.
TEST(ProgramGpu, ARunThatEndsAtOnceLeavesTheNamesOfDevices) {
    const Scratch scratch;
    const std::string json = (scratch.path() / "gpu.json").string();
    RunOptions options;
    options.whileRunning = [&json](pid_t) { return std::filesystem::exists(json) ? SIGKILL : 0; };
    const Outcome outcome = runProgram({"bench", "gpu", "--json", json}, options);
    if (absent(outcome)) GTEST_SKIP() << outcome.err;
    EXPECT_EQ(outcome.code, 128 + SIGKILL) << outcome.err;
    const Json::Value gpu = readJson(json)["gpu"];
    EXPECT_FALSE(gpu["complete"].asBool());
    EXPECT_EQ(gpu["checks"].size(), 0U) << "it was written before the first";
    EXPECT_EQ(gpu["devices"].size() + gpu["notMeasured"].size(), 2U) << "gl and cl";
    for (const Json::Value& device : gpu["devices"])
        for (const char* key : {"backend", "name", "driver"}) EXPECT_FALSE(device[key].asString().empty()) << key;
}

// As soon as the comparisons are done they are in the file, and stay there.
TEST(ProgramGpu, AnInterruptedRunLeavesWhatItKnows) {
    const Scratch scratch;
    const std::string json = (scratch.path() / "gpu.json").string();
    RunOptions options;
    options.whileRunning = [&json](pid_t) {
        const Result<std::string> text = readFile(json);
        return text && text->find("\"correct\"") != std::string::npos ? SIGINT : 0;
    };
    const Outcome outcome = runProgram({"bench", "gpu", "--quick", "--seconds", "900", "--json", json}, options);
    if (absent(outcome)) GTEST_SKIP() << outcome.err;
    EXPECT_EQ(outcome.code, 130) << outcome.err;
    const Json::Value all = readJson(json), &gpu = all["gpu"];
    EXPECT_FALSE(all["machine"].asString().empty());
    EXPECT_FALSE(gpu["complete"].asBool());
    EXPECT_TRUE(gpu["correct"].asBool());
    EXPECT_GE(gpu["checks"].size(), 12U);
}

TEST(ProgramGpu, AWrongKernelIsNamedAndEndsWithOne) {
    const Scratch scratch;
    const Shaders shaders(scratch);
    shaders.replace("fluid/methods/pbf_shift.kernel", "real3 x = xi - sum * LIGHTNESS;", "real3 x = xi + sum * LIGHTNESS;");
    const std::string json = (scratch.path() / "gpu.json").string();
    const Outcome outcome = runProgram({"bench", "gpu", "--quick", "--seconds", "900", "--json", json}, shaders.options());
    if (absent(outcome)) GTEST_SKIP() << outcome.err;
    EXPECT_EQ(outcome.code, 1);
    EXPECT_NE(outcome.err.find("pbf: largest difference of positions after 10 steps: "), std::string::npos) << outcome.err;
    EXPECT_EQ(outcome.err.find("wcsph: largest"), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.out.find("does not compute the same water as the cpu"), std::string::npos) << outcome.out;
    const Json::Value all = readJson(json);  // it is written nevertheless: a person sends it
    EXPECT_FALSE(all["gpu"]["correct"].asBool());
    EXPECT_NE(all["error"].asString().find("pbf"), std::string::npos);
}

// A kernel that one device cannot compile: the other is measured, and the file names both.
TEST(ProgramGpu, ADeviceThatFailsIsNamedAndTheOtherIsMeasured) {
    const std::pair<const char*, const char*> faults[] = {{"gl", "GL_core_profile"}, {"cl", "__OPENCL_C_VERSION__"}};
    for (const auto& [broken, macro] : faults) {
        SCOPED_TRACE(broken);
        const Scratch scratch;
        const Shaders shaders(scratch);
        for (const char* kernel : {"fluid/methods/wcsph_density.kernel", "bench/rate_copy.kernel"})
            shaders.replace(kernel, "KERNEL(", fmt::format("#ifdef {}\n#error planted\n#endif\nKERNEL(", macro));
        const std::string json = (scratch.path() / "gpu.json").string();
        const Outcome outcome = runProgram({"bench", "gpu", "--seconds", "12", "--json", json}, shaders.options());
        const Json::Value all = readJson(json), &gpu = all["gpu"];
        if (!gpu["notMeasured"].empty()) {
            EXPECT_EQ(std::getenv("RIVULET_TEST_DEVICES"), nullptr) << outcome.err;
            GTEST_SKIP() << outcome.err;
        }
        EXPECT_EQ(outcome.code, 1) << outcome.err;
        EXPECT_NE(outcome.err.find(fmt::format("a device failed: {}: wcsph: ", broken)), std::string::npos) << outcome.err;
        EXPECT_EQ(outcome.err.find("differs"), std::string::npos) << outcome.err;
        // Each device has a verdict of its own.
        const std::string same = "computes the same water as the cpu", other = broken == std::string("gl") ? "cl" : "gl";
        EXPECT_NE(outcome.out.find(fmt::format("({}) {} where it could be compared", broken, same)), std::string::npos) << outcome.out;
        EXPECT_NE(outcome.out.find(fmt::format("({}) {}", other, same)), std::string::npos) << outcome.out;
        EXPECT_EQ(outcome.out.find(fmt::format("({}) {} where it", other, same)), std::string::npos) << outcome.out;
        EXPECT_NE(outcome.out.find(fmt::format("Failed: {}: wcsph", broken)), std::string::npos) << outcome.out;
        EXPECT_TRUE(gpu["complete"].asBool());
        EXPECT_FALSE(gpu["correct"].asBool());
        EXPECT_NE(all["error"].asString().find("wcsph_density"), std::string::npos);
        const auto late = [&gpu](const std::string& device) {  // there was no time for its rates
            return std::any_of(gpu["leftOut"].begin(), gpu["leftOut"].end(), [&](const auto& what) { return what == device + ": rates"; });
        };
        ASSERT_EQ(gpu["devices"].size(), 2U);
        for (const Json::Value& device : gpu["devices"]) {
            for (const char* key : {"backend", "name", "driver"}) EXPECT_FALSE(device[key].asString().empty()) << key;
            EXPECT_EQ(device.isMember("rates"), device["backend"] != broken && !late(device["backend"].asString()));
        }
        std::map<std::string, int> passed, failed;
        for (const Json::Value& check : gpu["checks"]) ++(check["pass"].asBool() ? passed : failed)[check["device"].asString()];
        for (const auto& [device, count] : failed) EXPECT_EQ(device, broken) << count;
        EXPECT_GE(failed[broken], late(broken) ? 1 : 2) << "wcsph and rates";
        EXPECT_GE(passed[other], 2) << "positions and velocities of wcsph at least";
    }
}

// What was measured of a device stays, if it cannot draw.
TEST(ProgramGpu, APictureThatFailsLeavesTheStepsMeasured) {
    const Scratch scratch;
    const Shaders shaders(scratch);
    shaders.replace("screen_space/shade.frag", "void main() {", "#error planted\nvoid main() {");
    const std::string json = (scratch.path() / "gpu.json").string();
    const Outcome outcome = runProgram({"bench", "gpu", "--quick", "--seconds", "900", "--json", json}, shaders.options());
    const Json::Value gpu = readJson(json)["gpu"];
    if (gpu["devices"].empty() || gpu["devices"][0]["backend"] != "gl") {
        EXPECT_EQ(std::getenv("RIVULET_TEST_DEVICES"), nullptr) << outcome.err;
        GTEST_SKIP() << outcome.err;
    }
    EXPECT_EQ(outcome.code, 1);
    EXPECT_NE(outcome.err.find("gl: picture: "), std::string::npos) << outcome.err;
    EXPECT_EQ(gpu["series"].size(), 3U) << outcome.err;
    for (const Json::Value& row : gpu["series"]) {
        EXPECT_GT(row["stepMs"].asDouble(), 0);
        EXPECT_FALSE(row.isMember("drawMs"));
    }
    EXPECT_NE(outcome.out.find("(gl) computes the same water as the cpu where it could be compared; 1024 particles take"),
              std::string::npos)
        << outcome.out;
}

TEST(ProgramGpu, AnAbsentDeviceIsNamedWithTheReason) {
    const Scratch scratch;
    const std::string json = (scratch.path() / "gpu.json").string();
    RunOptions options;
    options.environment["OCL_ICD_VENDORS"] = "/nonexistent";
    Outcome outcome = runProgram({"bench", "gpu", "--seconds", "1", "--json", json}, options);
    EXPECT_NE(outcome.err.find("cl: not measured: this machine has no working OpenCL driver; install one"), std::string::npos)
        << outcome.err;
    EXPECT_EQ(outcome.err.find("--backend"), std::string::npos) << outcome.err;
    if (!absent(outcome)) {
        EXPECT_EQ(outcome.code, 0) << outcome.err;
        const Json::Value gpu = readJson(json)["gpu"];
        ASSERT_EQ(gpu["notMeasured"].size(), 1U);
        EXPECT_EQ(gpu["notMeasured"][0]["backend"].asString(), "cl");
        EXPECT_NE(gpu["notMeasured"][0]["reason"].asString().find("no working OpenCL driver"), std::string::npos);
        ASSERT_EQ(gpu["devices"].size(), 1U);
        EXPECT_EQ(gpu["devices"][0]["backend"].asString(), "gl");
    }
    // With neither, nothing is measured, which is no success.
    options.environment["__EGL_VENDOR_LIBRARY_FILENAMES"] = "/nonexistent.json";
    options.environment["EGL_PLATFORM"] = "none";
    outcome = runProgram({"bench", "gpu", "--json", json}, options);
    EXPECT_EQ(outcome.code, 1) << outcome.err;
    EXPECT_NE(outcome.err.find("needs OpenGL or OpenCL, and this machine has neither"), std::string::npos) << outcome.err;
    EXPECT_EQ(outcome.err.find("--backend"), std::string::npos) << outcome.err;
    const Json::Value all = readJson(json), &gpu = all["gpu"];
    EXPECT_NE(all["error"].asString().find("has neither"), std::string::npos);
    EXPECT_EQ(gpu["devices"].size(), 0U);
    ASSERT_EQ(gpu["notMeasured"].size(), 2U);
    for (const Json::Value& row : gpu["notMeasured"]) EXPECT_FALSE(row["reason"].asString().empty());
    EXPECT_NE(gpu["sentence"].asString().find("Nothing was measured: gl: "), std::string::npos);
}

TEST(ProgramGpu, BadArgumentsAreRefused) {
    expectRefusal(runProgram({"bench", "gpus"}), 2, "did you mean 'gpu'");
    expectRefusal(runProgram({"bench", "gpu", "--quik"}), 2, "did you mean '--quick'");
    expectRefusal(runProgram({"bench", "gpu", "--json", "/no_such_folder/gpu.json"}), 1, "/no_such_folder");
    const std::string help = runProgram({"bench", "--help"}).out;
    EXPECT_NE(help.find("\n  gpu "), std::string::npos);
    EXPECT_NE(help.find("gpu_model, chapter2"), std::string::npos) << "which cases write pages with --out";
    // Options that do nothing there.
    const Scratch scratch;
    const std::string out = (scratch.path() / "pages").string();
    expectRefusal(runProgram({"bench", "gpu", "--out", out}), 2, "--out has no effect on gpu; leave it out");
    expectRefusal(runProgram({"bench", "gpu", "gpu_model", "--runs", "7"}), 2, "--runs has no effect on gpu, gpu_model; leave it out");
    expectRefusal(runProgram({"bench", "voxels", "--quick"}), 2, "--quick has no effect on voxels; leave it out");
    expectRefusal(runProgram({"bench", "voxels", "--seconds", "5"}), 2, "--seconds has no effect on voxels; leave it out");
    EXPECT_FALSE(std::filesystem::exists(out));
    // The pages of gpu_model are files of --out.
    for (const char* page : {"gpus.md", "gpus.csv"})
        for (const char* option : {"--json", "--markdown"})
            expectRefusal(
                runProgram({"bench", "gpu_model", "--quick", "--out", scratch.path().string(), option, (scratch.path() / page).string()}),
                2, fmt::format("{} and --out would both write ", option));
}

}  // namespace
}  // namespace rivulet::testing::program_gpu_test
