// OpenCL as a person meets it: several devices to choose among, no driver at all, broken ones, a cache that is there or not.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "engine/compute/device_cl.h"
#include "tests/unit/program_runner.h"

namespace rivulet::testing::program_opencl_test {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> simulate(const std::string& scene, const Scratch& scratch, std::vector<std::string> more,
                                  const char* frames = "2") {
    more.insert(more.begin(), {"run", scene, "--headless", "--no-render", "--frames", frames, "--out", scratch.file("out")});
    return more;
}

std::string statsOf(const Scratch& scratch) {
    const Outcome text = runCommand({"cat", scratch.file("out/stats.json")});
    return text.out;
}

class ProgramOpenCl : public ::testing::Test {
  protected:
    void SetUp() override {
        if (listClDevices().empty()) GTEST_SKIP() << "this machine has no OpenCL";
    }
    Scratch scratch_;
    std::string scene_ = scratch_.file("small.json", smallScene());
};

TEST_F(ProgramOpenCl, DevicesAreListedWithTheirNames) {
    const std::vector<ClDeviceListing> all = listClDevices();
    const Outcome list = runProgram({"list", "devices"}), info = runProgram({"info"});
    for (size_t k = 0; k < all.size(); ++k) {
        EXPECT_NE(list.out.find("cl --device " + std::to_string(k + 1)), std::string::npos) << list.out;
        for (const std::string& out : {list.out, info.out}) {
            EXPECT_NE(out.find(all[k].name), std::string::npos) << out;
            EXPECT_NE(out.find(all[k].platform), std::string::npos) << out;
        }
    }
    for (const char* verb : {"run", "validate", "export", "voxelize"})
        EXPECT_NE(runProgram({verb, "--help"}).out.find("--device"), std::string::npos) << verb;
}

TEST_F(ProgramOpenCl, ADeviceIsChosenByANumberOrAPartOfItsName) {
    const ClDeviceListing first = listClDevices()[0];
    std::string shouted = first.name.substr(0, 4);
    std::transform(shouted.begin(), shouted.end(), shouted.begin(), [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
    for (const std::string& text : {std::string("1"), shouted, first.platform}) {
        const Outcome run = runProgram(simulate(scene_, scratch_, {"--device", text}));
        EXPECT_EQ(run.code, 0) << text << ": " << run.err;
        EXPECT_NE(statsOf(scratch_).find("\"backend\": \"cl\""), std::string::npos) << text << ": " << statsOf(scratch_);
        EXPECT_NE(statsOf(scratch_).find(first.name), std::string::npos) << text;
    }
    for (const char* text : {"no such device", "0", "99", "-1"}) {
        expectRefusal(runProgram(simulate(scene_, scratch_, {"--backend", "cl", "--device", text})), 2, text);
        expectRefusal(runProgram(simulate(scene_, scratch_, {"--backend", "cl", "--device", text})), 2, first.name);
    }
    for (const char* backend : {"cpu", "gl"})
        expectRefusal(runProgram(simulate(scene_, scratch_, {"--backend", backend, "--device", "1"})), 2, "OpenCL");
    expectRefusal(runProgram({"validate", "dam_break", "--device", "no such device"}), 2, first.name);
    expectRefusal(runProgram({"export", scene_, "--surface", "obj", "--device", "no such device"}), 2, first.name);
}

// PoCL can offer the processor several times.
TEST_F(ProgramOpenCl, IfSeveralDevicesMatchTheFirstIsUsedAndReported) {
    RunOptions two;
    two.environment["POCL_DEVICES"] = "basic pthread";
    const Outcome list = runProgram({"list", "devices"}, two);
    if (list.out.find("cl --device 2") == std::string::npos) GTEST_SKIP() << "one device, whatever is asked for";
    const Outcome run = runProgram(simulate(scene_, scratch_, {"--device", "Portable"}, "0"), two);
    EXPECT_EQ(run.code, 0) << run.err;
    EXPECT_NE(run.err.find("matches 2 OpenCL devices: using basic"), std::string::npos) << run.err;
    EXPECT_NE(statsOf(scratch_).find("\"device\": \"basic"), std::string::npos) << statsOf(scratch_);
    for (const char* text : {"2", "PTHREAD"}) {
        const Outcome second = runProgram(simulate(scene_, scratch_, {"--device", text}, "0"), two);
        EXPECT_EQ(second.code, 0) << second.err;
        EXPECT_EQ(second.err.find("names"), std::string::npos) << second.err;
        EXPECT_NE(statsOf(scratch_).find("\"device\": \"pthread"), std::string::npos) << text << ": " << statsOf(scratch_);
    }
}

// PoCL shares no memory with OpenGL: the staging ring is used, stats report the reason, and no notice is printed. Data that is not drawn is
// not brought over.
TEST_F(ProgramOpenCl, WithoutSharingTheRingIsUsedAndStatsReportTheReason) {
    if (runProgram({"list", "devices"}).out.find("Portable") == std::string::npos) GTEST_SKIP() << "this machine has no PoCL";
    const Outcome drawn = runProgram(
        {"run", scene_, "--headless", "--device", "Portable", "--size", "64x48", "--frames", "2", "--out", scratch_.file("out")});
    EXPECT_EQ(drawn.code, 0) << drawn.err;
    EXPECT_EQ(drawn.err, "");
    for (const char* said :
         {R"("backend": "cl")", R"("way": "ring")", R"("why": "Portable Computing Language offers no cl_khr_gl_sharing")"})
        EXPECT_NE(statsOf(scratch_).find(said), std::string::npos) << said << " in " << statsOf(scratch_);
    const Outcome undrawn = runProgram(simulate(scene_, scratch_, {"--device", "Portable"}));
    EXPECT_EQ(undrawn.code, 0) << undrawn.err;
    EXPECT_EQ(undrawn.err, "");
    for (const char* said : {R"("backend": "cl")", R"("way": "none")", R"("why": "")"})
        EXPECT_NE(statsOf(scratch_).find(said), std::string::npos) << said << " in " << statsOf(scratch_);
}

TEST_F(ProgramOpenCl, TheSecondStartFindsTheProgramsOfTheFirst) {
    RunOptions own;
    own.environment["XDG_CACHE_HOME"] = scratch_.file("cache");
    const fs::path folder = fs::path(scratch_.file("cache")) / "rivulet/cl";
    const auto programs = [&] {
        std::map<std::string, std::pair<fs::file_time_type, uintmax_t>> all;
        for (const auto& entry : fs::directory_iterator(folder)) all[entry.path()] = {entry.last_write_time(), entry.file_size()};
        return all;
    };
    const auto run = [&] { return runProgram(simulate(scene_, scratch_, {"--backend", "cl"}), own); };
    ASSERT_EQ(run().code, 0);
    ASSERT_TRUE(fs::exists(folder));
    const auto first = programs();
    EXPECT_GT(first.size(), 5U);
    // A damaged or foreign cache entry is rebuilt without a notice.
    const std::string cut = first.begin()->first, foreign = std::next(first.begin())->first;
    fs::resize_file(cut, first.begin()->second.second / 2);
    fs::copy_file(std::next(first.begin(), 2)->first, foreign, fs::copy_options::overwrite_existing);
    const Outcome second = run();
    EXPECT_EQ(second.code, 0);
    EXPECT_EQ(second.err, "");
    const auto then = programs();
    EXPECT_EQ(then.size(), first.size());
    EXPECT_GT(then.at(cut).second, first.begin()->second.second / 2);
    EXPECT_NE(statsOf(scratch_).find("\"backend\": \"cl\""), std::string::npos);
    // All of them are of use again.
    const auto before = fs::file_time_type::clock::now();
    ASSERT_EQ(run().code, 0);
    for (const auto& [path, entry] : programs()) EXPECT_GE(entry.first, before - std::chrono::seconds(2)) << path;
}

TEST_F(ProgramOpenCl, ACacheThatCannotBeIsNoTrouble) {
    const std::string file = scratch_.file("a_file", "text");
    for (const std::string& root : {file, std::string("/proc/none"), std::string("relative/path")}) {
        RunOptions nowhere;
        nowhere.folder = scratch_.path();  // PoCL takes a relative one
        nowhere.environment["XDG_CACHE_HOME"] = root;
        nowhere.environment["HOME"] = file;
        nowhere.environment["POCL_CACHE_DIR"] = scratch_.file("pocl");  // it does nothing without one
        const Outcome run = runProgram(simulate(scene_, scratch_, {"--backend", "cl"}), nowhere);
        EXPECT_EQ(run.code, 0) << root;
        EXPECT_EQ(run.err, "") << root;
        EXPECT_NE(statsOf(scratch_).find("\"backend\": \"cl\""), std::string::npos);
    }
}

// With no driver, and with drivers that are none, everything else works.
TEST(ProgramWithoutOpenCl, EverythingElseWorks) {
    const Scratch scratch;
    const std::string scene = scratch.file("small.json", smallScene());
    fs::create_directories(scratch.path() / "empty");
    fs::create_directories(scratch.path() / "gone");
    fs::create_directories(scratch.path() / "odd");
    (void)scratch.file("gone/gone.icd", "/nowhere/libgone.so\n");
    (void)scratch.file("odd/odd.icd", "libm.so.6\n");  // a library that is no driver
    for (const std::string& vendors : {std::string("/nonexistent"), scratch.file("empty"), scratch.file("gone"), scratch.file("odd")}) {
        SCOPED_TRACE(vendors);
        RunOptions none;
        none.environment["OCL_ICD_VENDORS"] = vendors;
        const Outcome info = runProgram({"info"}, none), list = runProgram({"list", "devices"}, none);
        EXPECT_EQ(info.code, 0) << info.err;
        EXPECT_NE(info.out.find("OpenCL   none"), std::string::npos) << info.out;
        EXPECT_EQ(list.code, 0) << list.err;
        EXPECT_EQ(list.out.find("--device"), std::string::npos) << list.out;
        // An absent backend is reported with a notice, and the cpu is used.
        for (const std::vector<std::string>& asked : {std::vector<std::string>{"--backend", "cl"}, {"--device", "some GPU"}}) {
            const Outcome run = runProgram(simulate(scene, scratch, asked), none);
            EXPECT_EQ(run.code, 0) << run.err;
            EXPECT_NE(run.err.find("no working OpenCL driver"), std::string::npos) << run.err;
            EXPECT_EQ(linesIn(run.err), 1U) << run.err;
            EXPECT_NE(statsOf(scratch).find("\"backend\": \"cpu\""), std::string::npos);
        }
        const Outcome calm = runProgram(simulate(scene, scratch, {}), none);
        EXPECT_EQ(calm.code, 0);
        EXPECT_EQ(calm.err, "");
        const Outcome drawn =
            runProgram({"run", scene, "--headless", "--frames", "2", "--size", "64x48", "--out", scratch.file("out")}, none);
        EXPECT_EQ(drawn.code, 0) << drawn.err;
        const Outcome meshes = runProgram(
            {"export", scene, "--surface", "obj", "--seconds", "0.05", "--out", scratch.file("meshes"), "--backend", "cl"}, none);
        EXPECT_EQ(meshes.code, 0) << meshes.err;
        EXPECT_NE(meshes.err.find("no working OpenCL driver"), std::string::npos) << meshes.err;
    }
}

}  // namespace
}  // namespace rivulet::testing::program_opencl_test
