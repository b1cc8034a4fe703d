// `rivulet run` headless: its output files, its messages, and its exit status after errors.
#include <gtest/gtest.h>
#include <json/json.h>
#include <signal.h>

#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "engine/core/file.h"
#include "engine/core/json.h"
#include "tests/unit/program_runner.h"

namespace rivulet::testing::program_run_test {
namespace {

namespace fs = std::filesystem;

Json::Value readJson(const fs::path& path) {
    std::ifstream stream(path);
    Json::Value value;
    std::string errors;
    EXPECT_TRUE(Json::parseFromStream(Json::CharReaderBuilder(), stream, &value, &errors)) << path << ": " << errors;
    return value;
}

// The video's frame count and size, as ffprobe counts them by decoding every frame; "" when the file is no video.
std::string probe(const fs::path& video) {
    return runCommand({"ffprobe", "-v", "error", "-count_frames", "-select_streams", "v", "-show_entries",
                       "stream=nb_read_frames,width,height", "-of", "csv=p=0", video.string()})
        .out;
}

TEST(ProgramRun, HeadlessLeavesVideoPicturesAndFigures) {
    Scratch scratch;
    std::string scene = scratch.file("small.json", smallScene());
    Outcome outcome = runProgram({"run", scene, "--size", "161x91", "--seconds", "0.2"}, in(scratch));
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_NE(outcome.out.find("out/small.mp4"), std::string::npos) << "the last line says where: " << outcome.out;
    EXPECT_EQ(linesIn(outcome.out), 1U) << outcome.out;
    EXPECT_EQ(probe(scratch.path() / "out/small.mp4"), "162,92,12\n") << "even sides, 60 frames a second";
    size_t pictures = 0;
    for (const std::string& name : scratch.contents()) pictures += name.ends_with(".png") ? 1 : 0;
    EXPECT_EQ(pictures, 6U);
    Json::Value stats = readJson(scratch.path() / "out/stats.json");
    EXPECT_EQ(stats["frames"].asInt(), 12);
    EXPECT_GT(stats["renderMs"]["median"].asDouble(), 0);
}

// The cpu steps while OpenGL draws: the images are the same, the trace shows the overlap, and stats report it.
// Ten thousand particles: a step is long beside a turn of the scheduler, so both work at once on a busy machine as well.
TEST(ProgramRun, SteppingBehindDrawingChangesNoPicture) {
    Scratch scratch;
    const std::string scene = scratch.file("small.json", R"({"name": "small", "fluid": {"spacing": 0.006,
        "box": {"min": [0, 0, 0], "max": [0.4, 0.4, 0.4]}, "blocks": [{"min": [0.05, 0.05, 0.05], "max": [0.2, 0.2, 0.15]}]}})");
    const std::vector<std::string> common = {"run", scene, "--headless", "--backend", "cpu", "--size", "160x90", "--frames", "8"};
    for (const char* plan : {"off", "behind"}) {
        std::vector<std::string> words = common;
        words.insert(words.end(), {"--cooperate", plan, "--out", plan, "--trace", std::string(plan) + ".json"});
        const Outcome outcome = runProgram(words, in(scratch));
        ASSERT_EQ(outcome.code, 0) << outcome.err;
        const Json::Value stats = readJson(scratch.path() / plan / "stats.json");
        EXPECT_EQ(stats["cooperation"]["plan"], plan);
        EXPECT_EQ(stats["transfer"]["way"], "ring");
        EXPECT_NE(stats["transfer"]["why"], "");
        EXPECT_GT(stats["transfer"]["bytes"].asDouble(), 0);
    }
    size_t compared = 0;
    for (const auto& entry : fs::directory_iterator(scratch.path() / "off")) {
        if (entry.path().extension() != ".png") continue;
        EXPECT_EQ(*readFile(entry.path().string()), *readFile((scratch.path() / "behind" / entry.path().filename()).string()))
            << entry.path();
        ++compared;
    }
    EXPECT_EQ(compared, 6U);
    EXPECT_GT(readJson(scratch.path() / "behind/stats.json")["cooperation"]["overlapMs"].asDouble(), 0);
    std::set<std::string> lanes;
    const Json::Value trace = readJson(scratch.path() / "behind.json");
    std::map<std::string, int> passes;  // how often each was drawn
    int drawing = 0;
    for (const Json::Value& event : trace["traceEvents"]) {
        if (event["ph"] == "M") {
            lanes.insert(event["args"]["name"].asString());
            if (event["args"]["name"] == "gl: drawing") drawing = event["tid"].asInt();
        } else if (event["tid"].asInt() == drawing) {
            ++passes[event["name"].asString()];
        }
    }
    EXPECT_EQ(passes["tonemap"], 8) << "the last frames', too";
    EXPECT_EQ(lanes, (std::set<std::string>{"cpu: ahead", "cpu: kernels", "gl: drawing", "main"}));
}

// With the cpu a frame ahead of the pictures, too: at the run's end, and where Ctrl-C ends it.
TEST(ProgramRun, TheSavedStateIsTheLastDrawnFrame) {
    Scratch scratch;
    const std::string scene = scratch.file("small.json", smallScene());
    const auto run = [&](const char* plan, const std::string& out, const std::vector<std::string>& more, const RunOptions& options) {
        std::vector<std::string> words = {"run",   scene, "--headless", "--backend",     "cpu",         "--size", "160x90",
                                          "--out", out,   "--save",     out + ".rstate", "--cooperate", plan};
        words.insert(words.end(), more.begin(), more.end());
        return runProgram(words, options);
    };
    const auto saved = [&](const std::string& out) { return *readFile((scratch.path() / (out + ".rstate")).string()); };
    for (const char* plan : {"off", "behind"}) EXPECT_EQ(run(plan, plan, {"--frames", "7"}, in(scratch)).code, 0);
    EXPECT_EQ(saved("behind"), saved("off"));
    // On from there, and the whole way.
    const Outcome resumed = run("behind", "resumed", {"--resume", "behind.rstate", "--frames", "5"}, in(scratch));
    EXPECT_EQ(resumed.code, 0) << resumed.err;
    EXPECT_EQ(run("off", "whole", {"--frames", "12"}, in(scratch)).code, 0);
    EXPECT_EQ(saved("resumed"), saved("whole"));

    RunOptions options = in(scratch);
    bool sent = false;
    options.whileRunning = [&](pid_t) {
        if (sent || !fs::exists(scratch.path() / "stopped/small_0000.png")) return 0;
        sent = true;
        return SIGINT;
    };
    EXPECT_EQ(run("behind", "stopped", {"--seconds", "600"}, options).code, 130);
    const Json::Value stats = readJson(scratch.path() / "stopped/stats.json");
    const std::string frames = std::to_string(stats["frames"].asInt());
    EXPECT_EQ(probe(scratch.path() / "stopped/small.mp4"), "160,90," + frames + "\n");
    EXPECT_EQ(run("off", "again", {"--frames", frames}, in(scratch)).code, 0);
    EXPECT_EQ(saved("stopped"), saved("again"));
}

TEST(ProgramRun, InvalidPlansAreRefused) {
    Scratch scratch;
    const std::string scene = scratch.file("small.json", smallScene());
    const Outcome typo = runProgram({"run", scene, "--cooperate", "thesi"}, in(scratch));
    EXPECT_EQ(typo.code, 2);
    EXPECT_NE(typo.err.find("thesis"), std::string::npos) << typo.err;
    const Outcome unwritable = runProgram({"run", scene, "--no-render", "--frames", "1", "--trace", "gone/trace.json"}, in(scratch));
    EXPECT_EQ(unwritable.code, 1);
    EXPECT_NE(unwritable.err.find("gone/trace.json"), std::string::npos) << unwritable.err;
    const Outcome alone =
        runProgram({"run", scene, "--no-render", "--frames", "1", "--backend", "cpu", "--cooperate", "thesis"}, in(scratch));
    EXPECT_EQ(alone.code, 0);
    EXPECT_NE(alone.err.find("GPU"), std::string::npos) << alone.err;
    const Outcome undrawn =
        runProgram({"run", scene, "--no-render", "--frames", "3", "--backend", "cl", "--cooperate", "thesis"}, in(scratch));
    EXPECT_EQ(undrawn.code, 0);
    EXPECT_NE(undrawn.err.find("nothing is drawn"), std::string::npos) << undrawn.err;
    EXPECT_EQ(readJson(scratch.path() / "out/stats.json")["cooperation"]["plan"], "off");
}

// Ten times slower than real time: a frame is a tenth of the time, and times are still in simulated seconds.
TEST(ProgramRun, SlowMotionTakesShorterStepsBetweenFrames) {
    Scratch scratch;
    const std::string scene = scratch.file("small.json", smallScene());
    Outcome outcome =
        runProgram({"run", scene, "--no-render", "--frames", "12", "--set", "timeScale=0.1", "--stats", "a.json"}, in(scratch));
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_NEAR(readJson(scratch.path() / "a.json")["seconds"].asDouble(), 0.02, 1e-9);
    outcome = runProgram({"run", scene, "--size", "32x32", "--still", "0.01", "--set", "timeScale=0.1"}, in(scratch));
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(readJson(scratch.path() / "out/stats.json")["frames"].asInt(), 7) << "the frame at a hundredth is the seventh";
}

// More frames than the limit are refused, for every option that sets them, before a file is written.
TEST(ProgramRun, MoreFramesThanCanBeCountedAreRefused) {
    Scratch scratch;
    scratch.file("s.json", smallScene());
    const std::vector<std::vector<std::string>> asked = {
        {"--seconds", "3600", "--set", "timeScale=1e-4"}, {"--set", "duration=3600", "--set", "timeScale=1e-4"}, {"--still", "1e300"}};
    for (const std::vector<std::string>& more : asked) {
        std::vector<std::string> words = {"run", "s.json", "--headless", "--backend", "cpu"};
        words.insert(words.end(), more.begin(), more.end());
        expectRefusal(runProgram(words, in(scratch)), 2, "60000000");
    }
    EXPECT_EQ(scratch.contents(), (std::vector<std::string>{"s.json"}));
}

// Moments alone: each is the same picture as in a run that is drawn throughout, and there is no video.
TEST(ProgramRun, StillsAreTheFramesOfTheWholeRun) {
    Scratch scratch;
    const std::string scene = scratch.file("small.json", smallScene());
    const auto run = [&](const std::string& out, const std::vector<std::string>& more) {
        std::vector<std::string> arguments = {"run", scene, "--headless", "--backend", "cpu", "--size", "96x64", "--out", out};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return runProgram(arguments, in(scratch));
    };
    const Outcome whole = run("whole", {"--frames", "11"}), stills = run("stills", {"--still", "0.0667", "--still", "0.1333"});
    ASSERT_EQ(whole.code, 0) << whole.err;
    ASSERT_EQ(stills.code, 0) << stills.err;
    const auto bytes = [&](const std::string& name) {
        std::ifstream stream(scratch.path() / name, std::ios::binary);
        return std::string(std::istreambuf_iterator<char>(stream), {});
    };
    std::set<std::string> names;
    for (const fs::directory_entry& entry : fs::directory_iterator(scratch.path() / "stills"))
        names.insert(entry.path().filename().string());
    EXPECT_EQ(names, (std::set<std::string>{"small_0004.png", "small_0008.png", "stats.json"}));
    for (const char* name : {"small_0004.png", "small_0008.png"}) {
        EXPECT_FALSE(bytes(std::string("stills/") + name).empty());
        EXPECT_EQ(bytes(std::string("stills/") + name), bytes(std::string("whole/") + name)) << name;
    }
    for (const char* text : {"-1", "soon", "1e30"}) {
        const Outcome refused = run("none", {"--still", text});
        EXPECT_EQ(refused.code, 2);
        EXPECT_NE(refused.err.find(text), std::string::npos) << refused.err;
    }
    EXPECT_EQ(run("none", {"--still", "0", "--no-render"}).code, 2);
}

// An iterative solver reports its iterations and residual; other methods report 0 and null.
TEST(ProgramRun, StatsReportTheWorkOfThePressureSolver) {
    Scratch scratch;
    const std::string scene = scratch.file("small.json", smallScene());
    const auto stats = [&](const std::string& method) {
        const Outcome outcome = runProgram({"run", scene, "--no-render", "--backend", "cpu", "--frames", "12", "--stats", "s.json", "--set",
                                            "fluid.method=" + method, "--set", "fluid.origin=10000,0,-2"},
                                           in(scratch));
        EXPECT_EQ(outcome.code, 0) << outcome.err;
        return readJson(scratch.path() / "s.json");
    };
    const Json::Value dfsph = stats("dfsph"), pbf = stats("pbf"), wcsph = stats("wcsph");
    EXPECT_GE(dfsph["iterations"].asDouble(), 1);
    EXPECT_LE(dfsph["iterations"].asDouble(), 50);
    ASSERT_TRUE(dfsph["residual"].isDouble());
    EXPECT_GE(dfsph["residual"].asDouble(), 0);
    EXPECT_LT(dfsph["residual"].asDouble(), 0.01);
    EXPECT_GE(pbf["iterations"].asDouble(), 1);
    EXPECT_EQ(wcsph["iterations"].asDouble(), 0);
    EXPECT_TRUE(wcsph["residual"].isNull());
    EXPECT_EQ(dfsph["origin"][0].asDouble(), 10000);
    EXPECT_LT(dfsph["centreOfMass"][0].asDouble(), 0.4) << "relative to the origin";
    EXPECT_EQ(dfsph["dropped"].asDouble(), 0);
}

TEST(ProgramRun, StatsHoldAllKeys) {
    Scratch scratch;
    std::string scene = scratch.file("small.json", smallScene());
    Outcome outcome =
        runProgram({"run", scene, "--headless", "--no-render", "--backend", "cpu", "--frames", "6", "--stats", "s.json"}, in(scratch));
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    Json::Value stats = readJson(scratch.path() / "s.json");
    for (const char* key :
         {"version",      "scene",    "machine",  "device", "backend", "method",     "particles",    "frames", "seconds", "wallSeconds",
          "simulateMs",   "renderMs", "frameMs",  "passes", "density", "energy",     "centreOfMass", "front",  "volume",  "lost",
          "penetrations", "nan",      "substeps", "dt",     "limited", "iterations", "residual",     "origin", "dropped", "sleep"})
        EXPECT_TRUE(stats.isMember(key)) << key;
    for (const char* group : {"simulateMs", "renderMs", "frameMs"})
        for (const char* key : {"min", "median", "p95"}) EXPECT_TRUE(stats[group].isMember(key)) << group << "." << key;
    EXPECT_EQ(stats["backend"].asString(), "cpu");
    EXPECT_EQ(stats["frames"].asInt(), 6);
    EXPECT_NEAR(stats["seconds"].asDouble(), 0.1, 1e-6);
    EXPECT_GT(stats["passes"].size(), 0U);
    EXPECT_LE(stats["simulateMs"]["min"].asDouble(), stats["simulateMs"]["median"].asDouble());
    EXPECT_LE(stats["simulateMs"]["median"].asDouble(), stats["simulateMs"]["p95"].asDouble());
    EXPECT_EQ(stats["lost"].asInt(), 0);
    EXPECT_EQ(stats["nan"].asInt(), 0);
    EXPECT_EQ(stats["penetrations"].asInt(), 0);

    // The block of 0.15 x 0.15 x 0.1 m falls freely for 0.1 s from its rest: g t^2 / 2.
    double volume = 0.15 * 0.15 * 0.1, spacing = 0.02;
    EXPECT_NEAR(stats["particles"].asDouble() * spacing * spacing * spacing, volume, 0.25 * volume);
    EXPECT_NEAR(stats["volume"].asDouble(), stats["particles"].asDouble() * spacing * spacing * spacing, 1e-6);
    EXPECT_NEAR(stats["centreOfMass"][0].asDouble(), 0.125, 0.011);
    EXPECT_NEAR(stats["centreOfMass"][1].asDouble(), 0.125 - 0.5 * 9.81 * 0.01, 0.012);
    double mass = 1000 * stats["volume"].asDouble();
    EXPECT_NEAR(stats["energy"]["kinetic"].asDouble(), 0.5 * mass * 0.981 * 0.981, 0.05 * 0.5 * mass * 0.981 * 0.981);
    EXPECT_NEAR(stats["energy"]["potential"].asDouble(), mass * 9.81 * stats["centreOfMass"][1].asDouble(), 1e-3);
    EXPECT_LT(stats["density"]["avgCompression"].asDouble(), 0.01);
}

TEST(ProgramRun, WithoutPicturesItWritesFiguresAlone) {
    Scratch scratch;
    std::string scene = scratch.file("small.json", smallScene());
    Outcome outcome =
        runProgram({"run", scene, "--headless", "--no-render", "--backend", "cpu", "--frames", "1", "--out", "here"}, in(scratch));
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(scratch.contents(), (std::vector<std::string>{"here", "here/stats.json", "small.json"}));
}

// Not an error: a notice, and the run continues.
TEST(ProgramRun, NoneOneAndCoincidentParticles) {
    Scratch scratch;
    auto sceneOf = [&](const std::string& blocks) {
        return scratch.file("few.json",
                            R"({"name": "few", "fluid": {"spacing": 0.02, "box": {"min": [0, 0, 0], "max": [0.4, 0.4, 0.4]}, "blocks": [)" +
                                blocks + "]}}");
    };
    std::string one = R"({"min": [0.1, 0.1, 0.1], "max": [0.12, 0.12, 0.12]})";
    auto run = [&](const std::string& blocks) {
        return runProgram({"run", sceneOf(blocks), "--headless", "--no-render", "--backend", "cpu", "--frames", "30", "--stats", "s.json"},
                          in(scratch));
    };
    Outcome none = run("");
    EXPECT_EQ(none.code, 0) << none.err;
    EXPECT_NE(none.err.find("particle"), std::string::npos) << "0 particles are said: " << none.err;
    Json::Value stats = readJson(scratch.path() / "s.json");
    EXPECT_EQ(stats["particles"].asInt(), 0);
    EXPECT_TRUE(stats["front"].isNull());

    Outcome single = run(one);
    EXPECT_EQ(single.code, 0) << single.err;
    stats = readJson(scratch.path() / "s.json");
    EXPECT_EQ(stats["particles"].asInt(), 1);
    EXPECT_EQ(stats["nan"].asInt(), 0);

    Outcome twins = run(one + ", " + one);
    EXPECT_EQ(twins.code, 0) << twins.err;
    stats = readJson(scratch.path() / "s.json");
    EXPECT_EQ(stats["particles"].asInt(), 2);
    EXPECT_EQ(stats["nan"].asInt(), 0);
    EXPECT_EQ(stats["lost"].asInt(), 0);
}

TEST(ProgramRun, CtrlCWhileAVideoIsWrittenClosesIt) {
    Scratch scratch;
    std::string scene = scratch.file("small.json", smallScene());
    RunOptions options = in(scratch);
    bool sent = false;
    options.whileRunning = [&](pid_t) {
        // The first frame's picture stands once the loop runs.
        if (sent || !fs::exists(scratch.path() / "out/small_0000.png")) return 0;
        sent = true;
        return SIGINT;
    };
    Outcome outcome = runProgram({"run", scene, "--headless", "--size", "160x90", "--seconds", "600"}, options);
    EXPECT_EQ(outcome.code, 130) << outcome.err;
    std::string seen = probe(scratch.path() / "out/small.mp4");
    EXPECT_TRUE(seen.starts_with("160,90,")) << "no valid video: " << seen;
    EXPECT_GT(std::atoi(seen.substr(7).c_str()), 0) << seen;
    EXPECT_TRUE(fs::exists(scratch.path() / "out/stats.json"));
    for (const std::string& name : scratch.contents()) EXPECT_EQ(name.find(".rivulet-"), std::string::npos) << "left behind: " << name;
}

// Exit 1, one sentence, nothing half-written.
void expectFailure(const Outcome& outcome, const std::string& mentions) {
    EXPECT_EQ(outcome.code, 1) << outcome.err;
    EXPECT_NE(outcome.err.find(mentions), std::string::npos) << "'" << mentions << "' is not in: " << outcome.err;
    EXPECT_TRUE(outcome.err.starts_with("rivulet: ")) << outcome.err;
}

TEST(ProgramRun, OutputThatCannotBeWrittenIsAFailure) {
    Scratch scratch;
    std::string scene = scratch.file("small.json", smallScene());
    std::string blocker = scratch.file("blocker", "a file, not a folder");
    std::vector<std::string> before = scratch.contents();
    std::vector<std::string> base = {"run", scene, "--headless", "--size", "64x48", "--frames", "3"};
    auto with = [&](std::vector<std::string> more) {
        std::vector<std::string> words = base;
        words.insert(words.end(), more.begin(), more.end());
        return runProgram(words, in(scratch));
    };
    expectFailure(with({"--out", "blocker/below"}), "blocker");
    expectFailure(with({"--out", "/proc/rivulet"}), "/proc");
    expectFailure(with({"--no-render", "--stats", "/dev/full"}), "/dev/full");
    expectFailure(with({"--no-render", "--stats", "blocker/s.json"}), "blocker/s.json");
    EXPECT_EQ(scratch.contents(), before);
    expectFailure(with({"--out", "o", "--video", "/dev/full"}), "/dev/full");
    expectFailure(with({"--out", "o", "--video", "nowhere/x.mp4"}), "nowhere/x.mp4");
    for (const std::string& name : scratch.contents()) {
        EXPECT_FALSE(name.ends_with(".mp4")) << name;
        EXPECT_EQ(name.find(".rivulet-"), std::string::npos) << "left behind: " << name;
    }
    EXPECT_TRUE(fs::is_character_file("/dev/full")) << "a device must not be replaced by a file";
}

TEST(ProgramRun, WithoutFfmpegAVideoIsAFailureThatNamesThePackage) {
    Scratch scratch;
    std::string scene = scratch.file("small.json", smallScene());
    RunOptions options = in(scratch);
    options.environment["PATH"] = scratch.path().string();
    expectFailure(runProgram({"run", scene, "--headless", "--size", "64x48", "--frames", "1"}, options), "ffmpeg");
}

TEST(ProgramRun, NoOpenGlWhereAPictureWasAskedForIsAFailure) {
    Scratch scratch;
    std::string scene = scratch.file("small.json", smallScene());
    RunOptions options = in(scratch);
    options.environment["__EGL_VENDOR_LIBRARY_FILENAMES"] = "/nonexistent.json";
    options.environment["EGL_PLATFORM"] = "none";
    Outcome outcome = runProgram({"run", scene, "--headless", "--size", "64x48", "--frames", "1"}, options);
    expectFailure(outcome, "OpenGL");
    Outcome without = runProgram({"run", scene, "--headless", "--no-render", "--frames", "1", "--stats", "s.json"}, options);
    EXPECT_EQ(without.code, 0) << without.err;
    EXPECT_EQ(readJson(scratch.path() / "s.json")["backend"].asString(), "cpu");
}

TEST(ProgramRun, AnAbsentBackendIsReportedAndTheCpuRuns) {
    Scratch scratch;
    std::string scene = scratch.file("small.json", smallScene());
    RunOptions options = in(scratch);
    options.environment["OCL_ICD_VENDORS"] = "/nonexistent";
    Outcome outcome =
        runProgram({"run", scene, "--headless", "--no-render", "--backend", "cl", "--frames", "2", "--stats", "s.json"}, options);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_NE(outcome.err.find("OpenCL"), std::string::npos) << outcome.err;
    EXPECT_EQ(readJson(scratch.path() / "s.json")["backend"].asString(), "cpu");
}

TEST(ProgramRun, SetChangesAParameter) {
    Scratch scratch;
    std::string scene = scratch.file("small.json", smallScene());
    auto height = [&](const std::string& gravity) {
        Outcome outcome = runProgram({"run", scene, "--headless", "--no-render", "--backend", "cpu", "--frames", "6", "--stats", "s.json",
                                      "--set", "fluid.gravity=[0," + gravity + ",0]", "--set", "name=other"},
                                     in(scratch));
        EXPECT_EQ(outcome.code, 0) << outcome.err;
        Json::Value stats = readJson(scratch.path() / "s.json");
        EXPECT_EQ(stats["scene"].asString(), "other");
        return stats["centreOfMass"][1].asDouble();
    };
    EXPECT_NEAR(height("0") - height("-4"), 0.5 * 4 * 0.01, 0.002);
}

}  // namespace
}  // namespace rivulet::testing::program_run_test
