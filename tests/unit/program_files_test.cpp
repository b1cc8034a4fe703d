// The files of the program: what exists is never lost, what is no file is never read, messages never reach a data file or control a
// terminal.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <pty.h>
#include <signal.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <fstream>

#include "engine/core/file.h"
#include "engine/core/sanitized.h"
#include "tests/unit/program_runner.h"

namespace rivulet::testing::program_files_test {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

constexpr int kKilled = 128 + SIGKILL;

// A program that waits for ever is killed, and its status is then kKilled.
RunOptions patientIn(const Scratch& scratch) {
    RunOptions options = in(scratch);
    options.whileRunning = [looks = 0](pid_t) mutable { return ++looks == 3000 ? SIGKILL : 0; };
    return options;
}

Words joined(Words words, const Words& more) {
    words.insert(words.end(), more.begin(), more.end());
    return words;
}

// Names of files that are not complete.
Words unfinished(const Scratch& scratch) {
    Words names;
    for (const std::string& name : scratch.contents())
        if (name.find(".rivulet-") != std::string::npos || name.ends_with(".tmp")) names.push_back(name);
    return names;
}

// The bytes of the largest file whose name contains `part`, beside the one that is called so.
uintmax_t bytesBeside(const Scratch& scratch, const std::string& part, const std::string& old) {
    uintmax_t most = 0;
    for (const auto& entry : fs::directory_iterator(scratch.path())) {
        std::error_code gone;
        const std::string name = entry.path().filename().string();
        const uintmax_t bytes = fs::file_size(entry.path(), gone);
        if (gone || name.find(part) == std::string::npos || (name == part && bytes == old.size())) continue;
        most = std::max(most, bytes);
    }
    return most;
}

const Words kRecord = {"run", "s.json", "--no-render", "--backend", "cpu", "--record", "s.rrec"};

// A folder with a scene and a recording of it. Returns the recording's bytes.
std::string recordingIn(const Scratch& scratch) {
    scratch.file("s.json", smallScene());
    const Outcome made = runProgram(joined(kRecord, {"--frames", "4"}), in(scratch));
    EXPECT_EQ(made.code, 0) << made.err;
    return scratch.text("s.rrec");
}

// One frame of it is drawn; returns what the program reports.
std::string shown(const Scratch& scratch, const std::string& recording) {
    const Outcome outcome = runProgram(
        {"run", "s.json", "--headless", "--size", "64x48", "--still", "0", "--out", "shown", "--replay", recording}, in(scratch));
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return outcome.err;
}

void limitFiles(rlim_t bytes) {
    const rlimit limit{bytes, bytes};
    setrlimit(RLIMIT_FSIZE, &limit);
}

// A file system of its own, as small as asked; false: this process may not mount.
class SmallDisk {
  public:
    SmallDisk(const fs::path& at, const std::string& size) : at_(at) {
        fs::create_directory(at);
        there_ = mount("tmpfs", at.c_str(), "tmpfs", 0, ("size=" + size).c_str()) == 0;
    }
    ~SmallDisk() {
        if (there_) umount2(at_.c_str(), MNT_DETACH);
    }
    SmallDisk(const SmallDisk&) = delete;
    SmallDisk& operator=(const SmallDisk&) = delete;
    explicit operator bool() const { return there_; }

  private:
    fs::path at_;
    bool there_ = false;
};

TEST(ProgramFiles, AFileLimitLeavesTheOldRecording) {
    const Scratch scratch;
    const std::string old = recordingIn(scratch);
    RunOptions limited = in(scratch);
    limited.before = [] { limitFiles(100'000); };
    const Outcome outcome = runProgram(joined(kRecord, {"--frames", "10000"}), limited);
    expectRefusal(outcome, 1, "s.rrec: frame ");
    EXPECT_NE(outcome.err.find("ulimit -f); the older file is unchanged"), std::string::npos) << outcome.err;
    EXPECT_TRUE(scratch.text("s.rrec") == old);
    // Where no recording would be lost, the frames until then stay.
    fs::remove(scratch.path() / "s.rrec");
    expectRefusal(runProgram(joined(kRecord, {"--frames", "10000"}), limited), 1, "s.rrec: frame ");
    EXPECT_NE(shown(scratch, "s.rrec").find("has no end"), std::string::npos);
    EXPECT_EQ(unfinished(scratch), Words{});
}

TEST(ProgramFiles, AFullDiskLeavesTheOldFiles) {
    const Scratch scratch;
    scratch.file("s.json", smallScene());
    const SmallDisk disk(scratch.path() / "disk", "128k");
    if (!disk) GTEST_SKIP() << "only root can mount a small disk";
    const Words run = {"run", "s.json", "--no-render", "--backend", "cpu", "--stats", "disk/stats.json", "--save", "disk/s.rstate"};
    ASSERT_EQ(runProgram(joined(run, {"--frames", "2", "--record", "disk/s.rrec"}), in(scratch)).code, 0);
    const std::string recording = scratch.text("disk/s.rrec"), state = scratch.text("disk/s.rstate"),
                      stats = scratch.text("disk/stats.json");
    expectRefusal(runProgram(joined(run, {"--frames", "10000", "--record", "disk/s.rrec"}), in(scratch)), 1,
                  "cannot be written: the disk is full; the older file is unchanged");
    EXPECT_TRUE(scratch.text("disk/s.rrec") == recording);
    // No room is left for anything.
    std::ofstream(scratch.path() / "disk/fill") << std::string(1 << 20, 'x');
    expectRefusal(runProgram(joined(run, {"--frames", "3"}), in(scratch)), 1, "the disk is full");
    expectRefusal(runProgram({"export", "s.json", "--backend", "cpu", "--format", "csv", "--out", "disk", "--seconds", "0.1"}, in(scratch)),
                  1, "the disk is full");
    EXPECT_TRUE(scratch.text("disk/s.rrec") == recording);
    EXPECT_TRUE(scratch.text("disk/s.rstate") == state);
    EXPECT_TRUE(scratch.text("disk/stats.json") == stats);
    EXPECT_EQ(unfinished(scratch), Words{});
}

TEST(ProgramFiles, AKilledRunLeavesTheOldRecording) {
    const Scratch scratch;
    const std::string old = recordingIn(scratch);
    RunOptions killed = in(scratch);
    killed.whileRunning = [&](pid_t) { return bytesBeside(scratch, "s.rrec", old) > 60'000 ? SIGKILL : 0; };
    EXPECT_EQ(runProgram(joined(kRecord, {"--frames", "1000000"}), killed).code, kKilled);
    EXPECT_TRUE(scratch.text("s.rrec") == old);
    EXPECT_EQ(shown(scratch, "s.rrec"), "");
    // What the killed run left is not complete, and can be shown.
    const Words left = unfinished(scratch);
    ASSERT_EQ(left.size(), 1U);
    EXPECT_NE(shown(scratch, left[0]).find("has no end"), std::string::npos);
}

// Where no recording would be lost, the frames of a killed run are under the name that was given.
TEST(ProgramFiles, AKilledRunLeavesItsFramesInANewRecording) {
    const Scratch scratch;
    scratch.file("s.json", smallScene());
    RunOptions killed = in(scratch);
    killed.whileRunning = [&](pid_t) { return bytesBeside(scratch, "s.rrec", "") > 60'000 ? SIGKILL : 0; };
    EXPECT_EQ(runProgram(joined(kRecord, {"--frames", "1000000"}), killed).code, kKilled);
    EXPECT_EQ(unfinished(scratch), Words{});
    EXPECT_NE(shown(scratch, "s.rrec").find("has no end"), std::string::npos);
}

TEST(ProgramFiles, AnInterruptedRecordingIsClosedAndReplacesTheOldOne) {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
        const Scratch scratch;
        const std::string old = recordingIn(scratch);
        RunOptions stopped = in(scratch);
        // A shell repeats the SIGHUP of its terminal.
        stopped.whileRunning = [&, sent = 0](pid_t) mutable {
            const int most = signal == SIGHUP ? 5 : 1;
            if (sent == most || (sent == 0 && bytesBeside(scratch, "s.rrec", old) < 60'000)) return 0;
            ++sent;
            return signal;
        };
        EXPECT_EQ(runProgram(joined(kRecord, {"--frames", "1000000"}), stopped).code, 128 + signal);
        EXPECT_GT(scratch.text("s.rrec").size(), 60'000U);
        EXPECT_EQ(shown(scratch, "s.rrec"), "") << "it is complete";
        EXPECT_EQ(unfinished(scratch), Words{});
        EXPECT_TRUE(fs::exists(scratch.path() / "out/stats.json"));
    }
}

TEST(ProgramFiles, AVideoThatFailsLeavesTheOldOne) {
    const Scratch scratch;
    scratch.file("s.json", smallScene());
    scratch.file("v.mp4", "the old video");
    RunOptions limited = in(scratch);
    limited.before = [] { limitFiles(20'000); };
    const Outcome outcome =
        runProgram({"run", "s.json", "--headless", "--size", "320x240", "--frames", "200", "--video", "v.mp4"}, limited);
    EXPECT_EQ(outcome.code, 1) << outcome.err;
    EXPECT_EQ(linesIn(outcome.err), 1U) << outcome.err;
    EXPECT_EQ(scratch.text("v.mp4"), "the old video");
    EXPECT_EQ(unfinished(scratch), Words{});
}

// The name of a video is the name of a file, whatever it looks like to ffmpeg.
TEST(ProgramFiles, AVideoMayHaveAnyName) {
    const Scratch scratch;
    scratch.file("s.json", smallScene());
    for (const char* name : {"http:video.mp4", "./-y.mp4", "pipe:1.mkv"}) {
        const Outcome outcome =
            runProgram({"run", "s.json", "--headless", "--size", "64x48", "--frames", "2", "--video", name}, in(scratch));
        EXPECT_EQ(outcome.code, 0) << outcome.err;
        EXPECT_TRUE(fs::exists(scratch.path() / name)) << name;
    }
}

TEST(ProgramFiles, OneNameForTwoFilesIsRefused) {
    const Scratch scratch;
    recordingIn(scratch);
    fs::create_directory(scratch.path() / "d");
    fs::create_symlink("..", scratch.path() / "d/up");
    fs::create_symlink("s.json", scratch.path() / "link.json");
    scratch.file("ball.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    scratch.file("ball.json", smallScene(R"("colliders": [{"mesh": "ball.obj"}])"));
    scratch.file("small_0003.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    scratch.file("last.json", smallScene(R"("colliders": [{"mesh": "small_0003.obj"}])"));
    ASSERT_EQ(runProgram({"run", "s.json", "--no-render", "--backend", "cpu", "--frames", "1", "--save", "s.rstate", "--stats", "old.json"},
                         in(scratch))
                  .code,
              0);
    const Words before = scratch.contents();
    std::vector<std::string> bytes;
    const auto refused = [&](const Words& words, const std::string& mentions) {
        expectRefusal(runProgram(words, in(scratch)), 2, mentions);
    };
    const Words run = {"run", "s.json", "--no-render", "--backend", "cpu", "--frames", "1"},
                drawn = {"run", "s.json", "--headless", "--size", "64x48", "--frames", "1"};
    // Two outputs.
    refused(joined(run, {"--stats", "a.json", "--trace", "a.json"}),
            "--stats and --trace would both write a.json; give each a file of its own");
    refused(joined(run, {"--save", "a", "--record", "./d/../a"}), "--save and --record would both write a");
    refused(joined(run, {"--save", "new", "--record", "d/up/new"}), "--save and --record would both write new");
    refused(joined(run, {"--save", "old.json", "--stats", "d/up/old.json"}), "--stats and --save would both write d/up/old.json");
    refused(joined(run, {"--save", "out/stats.json"}), "--stats and --save would both write out/stats.json");
    refused(joined(drawn, {"--save", "out/small.mp4"}), "--save and --video would both write out/small.mp4");
    refused(joined(drawn, {"--save", "out/small_0000.png"}), "--save and --out would both write out/small_0000.png");
    refused({"voxelize", "ball.obj", "--slices", "a.png", "--picture", "d/../a.png"}, "--slices and --picture would both write a.png");
    refused({"bench", "voxels", "--json", "a", "--markdown", "a"}, "--json and --markdown would both write a");
    refused({"validate", "hydrostatic", "--json", "d/a.svg", "--pictures", "d"}, "--json and --pictures would both write d/a.svg");
    // An output over an input.
    refused(joined(run, {"--stats", "s.json"}), "--stats would overwrite s.json, which is an input (the scene); choose another file name");
    refused(joined(run, {"--stats", "link.json"}), "--stats would overwrite s.json, which is an input (the scene)");
    refused(joined(run, {"--resume", "s.rstate", "--save", "d/up/s.rstate"}),
            "--save would overwrite s.rstate, which is an input (--resume)");
    refused(joined(run, {"--resume", "s.rstate", "--record", "s.rstate"}), "--record would overwrite s.rstate");
    refused({"run", "s.json", "--headless", "--replay", "s.rrec", "--video", "s.rrec"}, "--video would overwrite s.rrec");
    refused({"run", "ball.json", "--no-render", "--stats", "d/up/ball.obj"},
            "--stats would overwrite ball.obj, which is an input (colliders[0].mesh)");
    refused({"voxelize", "ball.obj", "--stats", "d/up/ball.obj"}, "--stats would overwrite ball.obj, which is an input (MESH)");
    refused({"export", "last.json", "--surface", "obj", "--out", "."}, "--surface would overwrite small_0003.obj");
    EXPECT_EQ(scratch.contents(), before);
    // A device takes all.
    EXPECT_EQ(runProgram(joined(run, {"--stats", "/dev/null", "--trace", "/dev/null"}), in(scratch)).code, 0);
}

TEST(ProgramFiles, TheFileOfStandardOutputIsNoOutput) {
    const Scratch scratch;
    scratch.file("s.json", smallScene());
    RunOptions redirected = in(scratch);
    redirected.stdoutFile = scratch.file("log", "log");
    const Outcome outcome = runProgram({"run", "s.json", "--no-render", "--frames", "1", "--stats", "log"}, redirected);
    expectRefusal(outcome, 2, "--stats would replace log, to which standard output is redirected");
    // By the name of the descriptor it goes there, as into a pipe, and what is there stays.
    for (const char* name : {"/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"}) {
        const Outcome written = runCommand({"bash", "-c", R"(echo begun >both; "$0" "$@" >>both; echo ended >>both)", RIVULET_PROGRAM,
                                            "run", "s.json", "--no-render", "--backend", "cpu", "--frames", "1", "--stats", name},
                                           in(scratch));
        EXPECT_EQ(written.err, "");
        const std::string both = readFile((scratch.path() / "both").string()).value();
        EXPECT_TRUE(both.starts_with("begun\n{")) << name << ": " << both;
        EXPECT_NE(both.find("\"wallSeconds\""), std::string::npos) << both;
        EXPECT_TRUE(both.ends_with("\nended\n")) << both;
    }
}

// Only names that a run may write: those with the number of a frame.
TEST(ProgramFiles, InputsThatOnlyBeginAsOutputsAreFine) {
    const Scratch scratch;
    scratch.file("small_low.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n");
    scratch.file("s.json", smallScene(R"("colliders": [{"mesh": "small_low.obj", "fitSize": 0.1, "position": [0.3, 0.1, 0.3]}])"));
    const Outcome exported = runProgram({"export", "s.json", "--surface", "obj", "--out", ".", "--seconds", "0.02"}, in(scratch));
    EXPECT_EQ(exported.code, 0) << exported.err;
    EXPECT_TRUE(fs::exists(scratch.path() / "small_0000.obj"));
}

// The log is about what is missing: the descriptor that it is written to must not belong to the recording.
TEST(ProgramFiles, MessagesNeverReachADataFile) {
    const Scratch scratch;
    scratch.file("s.json", R"({"name": "small", "fluid": {"spacing": 0.02, "method": "wcsph", "maxSubsteps": 1,
        "box": {"min": [0, 0, 0], "max": [0.4, 0.4, 0.4]}, "blocks": [{"min": [0.05, 0.05, 0.05], "max": [0.2, 0.2, 0.15]}]}})");
    const auto run = [&](const std::string& name, const std::vector<int>& closed) {
        RunOptions options = in(scratch);
        options.before = [&] {
            for (const int stream : closed) close(stream);
        };
        return runProgram({"run", "s.json", "--no-render", "--frames", "20", "--backend", "cpu", "--record", name + ".rrec", "--save",
                           name + ".rstate", "--stats", name + ".json"},
                          options);
    };
    const Outcome open = run("open", {});
    ASSERT_EQ(open.code, 0) << open.err;
    ASSERT_NE(open.err, "") << "a scene with messages during the run";
    const std::vector<std::vector<int>> cases = {{0}, {1}, {2}, {0, 1}, {0, 2}, {1, 2}, {0, 1, 2}};
    for (size_t k = 0; k < cases.size(); ++k) {
        const std::string name = "closed" + std::to_string(k);
        const bool printed = std::find(cases[k].begin(), cases[k].end(), 1) == cases[k].end();
        const Outcome outcome = run(name, cases[k]);
        EXPECT_EQ(outcome.code, printed ? 0 : 1) << outcome.err;
        EXPECT_TRUE(scratch.text(name + ".rrec") == scratch.text("open.rrec")) << k;
        EXPECT_TRUE(scratch.text(name + ".rstate") == scratch.text("open.rstate")) << k;
        EXPECT_EQ(scratch.text(name + ".json")[0], '{') << k;
    }
}

// A pipe without a writer would be waited for, a device has no end, and files of the system are nobody's scene.
TEST(ProgramFiles, WhatIsNoFileIsRefusedAsInput) {
    const Scratch scratch;
    recordingIn(scratch);
    ASSERT_EQ(mkfifo((scratch.path() / "pipe").c_str(), 0600), 0);
    fs::create_directory(scratch.path() / "scenes");
    ASSERT_EQ(mkfifo((scratch.path() / "scenes/pipe.json").c_str(), 0600), 0);
    struct Kind {
        std::string path, why;
    };
    const std::vector<Kind> kinds = {{"pipe", "it is a pipe"},
                                     {"/dev/zero", "it is a device"},
                                     {"/proc/self/environ", "it is on a virtual file system"},
                                     {"scenes", "is a folder"}};
    for (const Kind& kind : kinds) {
        const std::string& path = kind.path;
        scratch.file("mesh.json", smallScene(R"("colliders": [{"mesh": ")" + path + "\"}]"));
        scratch.file("block.json", R"({"fluid": {"spacing": 0.02, "blocks": [{"shape": "mesh", "mesh": ")" + path + "\"}]}}");
        scratch.file("sky.json", smallScene(R"("background": {"surroundings": ")" + path + "\"}"));
        scratch.file("skin.json", smallScene(R"("flow": [{"mesh": ")" + path + "\"}]"));
        scratch.file("marks.json", smallScene(R"("flow": [{"mesh": "meshes/head/head.glb", "marks": ")" + path + "\"}]"));
        for (const Words& words : {Words{"run", path, "--no-render"}, Words{"run", "s.json", "--no-render", "--resume", path},
                                   Words{"run", "s.json", "--headless", "--replay", path}, Words{"voxelize", path, "--out", "x.rvox"},
                                   Words{"run", "mesh.json", "--no-render"}, Words{"run", "block.json", "--no-render"},
                                   Words{"run", "sky.json", "--headless", "--size", "64x48"}, Words{"run", "skin.json", "--no-render"},
                                   Words{"run", "marks.json", "--no-render"}, Words{"export", path, "--format", "csv"}}) {
            const Outcome outcome = runProgram(joined(words, {"--backend", "cpu"}), patientIn(scratch));
            EXPECT_EQ(outcome.code, 2) << words[1] << ", " << path << ": " << outcome.err;
            EXPECT_NE(outcome.err.find(kind.why), std::string::npos) << words[1] << ", " << path << ": " << outcome.err;
        }
    }
    const Outcome list = runProgram({"list", "scenes"}, patientIn(scratch));
    EXPECT_EQ(list.code, 0);
    EXPECT_NE(list.out.find("it is a pipe"), std::string::npos) << list.out;
}

// A signal that comes again ends the program at once, without what it has begun.
TEST(ProgramFiles, ASecondSignalLeavesNoTemporaryFile) {
    const Scratch scratch;
    const std::string old = recordingIn(scratch);
    RunOptions stopped = in(scratch);
    stopped.whileRunning = [&](pid_t) { return bytesBeside(scratch, "s.rrec", old) > 60'000 ? SIGTERM : 0; };
    const Outcome outcome = runProgram(joined(kRecord, {"--frames", "1000000", "--save", "s.rstate"}), stopped);
    EXPECT_EQ(outcome.code, 128 + SIGTERM) << outcome.err;
    EXPECT_EQ(unfinished(scratch), Words{});
}

// Verbs that have nothing to close end at once.
TEST(ProgramFiles, EverySignalHasItsStatus) {
    const Scratch scratch;
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
        RunOptions stopped = in(scratch);
        stopped.whileRunning = [&, looks = 0](pid_t) mutable { return ++looks == 60 ? signal : 0; };
        EXPECT_EQ(runProgram({"validate", "--json", "v.json"}, stopped).code, 128 + signal);
    }
    EXPECT_EQ(scratch.contents(), Words{});
}

// nohup ignores SIGHUP, and so does a program that it starts.
TEST(ProgramFiles, AnIgnoredHangupStaysIgnored) {
    const Scratch scratch;
    const std::string old = recordingIn(scratch);
    RunOptions options = in(scratch);
    options.before = [] { signal(SIGHUP, SIG_IGN); };
    options.whileRunning = [&, sent = 0](pid_t) mutable {
        if (bytesBeside(scratch, "s.rrec", old) < 60'000) return 0;
        return ++sent < 20 ? SIGHUP : SIGINT;
    };
    EXPECT_EQ(runProgram(joined(kRecord, {"--frames", "1000000"}), options).code, 128 + SIGINT);
}

// The terminal is closed while a bar of progress is drawn on it: the files are complete.
TEST(ProgramFiles, AClosedTerminalEndsTheRunInOrder) {
    const Scratch scratch;
    scratch.file("s.json", smallScene());
    int terminal = -1;
    const pid_t child = forkpty(&terminal, nullptr, nullptr, nullptr);
    if (child == 0) {
        if (chdir(scratch.path().c_str()) != 0) _exit(126);
        for (const char* variable : {"DISPLAY", "WAYLAND_DISPLAY"}) unsetenv(variable);
        execl(RIVULET_PROGRAM, "rivulet", "run", "s.json", "--headless", "--size", "64x48", "--frames", "1000000", "--record", "s.rrec",
              nullptr);
        _exit(127);
    }
    ASSERT_GE(terminal, 0);
    std::string seen;
    std::array<char, 4096> piece{};
    while (seen.find("ms a frame") == std::string::npos) {
        const ssize_t got = read(terminal, piece.data(), piece.size());
        ASSERT_GT(got, 0) << seen;
        seen.append(piece.data(), static_cast<size_t>(got));
    }
    close(terminal);
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFEXITED(status)) << "signal " << WTERMSIG(status);
    EXPECT_EQ(WEXITSTATUS(status), 128 + SIGHUP);
    EXPECT_EQ(unfinished(scratch), Words{});
    for (const char* name : {"s.rrec", "out/small.mp4", "out/stats.json"}) EXPECT_TRUE(fs::exists(scratch.path() / name)) << name;
    EXPECT_EQ(shown(scratch, "s.rrec"), "");
}

// What reads the output has ended: no message, a status that is not 0, and all files are written.
TEST(ProgramFiles, AClosedPipeIsNoNoise) {
    const Scratch scratch;
    scratch.file("s.json", smallScene());
    for (const bool ignored : {false, true}) {
        RunOptions options = in(scratch);
        options.before = [ignored] {
            int ends[2];
            if (pipe(ends) != 0 || dup2(ends[1], STDOUT_FILENO) < 0) _exit(126);
            close(ends[0]);
            close(ends[1]);
            signal(SIGPIPE, ignored ? SIG_IGN : SIG_DFL);
        };
        for (const Words& words : {Words{"list"}, Words{"info"}, Words{"--help"},
                                   Words{"validate", "rotating_patch", "--method", "pbf", "--quick"}, joined(kRecord, {"--frames", "2"})}) {
            const Outcome outcome = runProgram(words, options);
            EXPECT_EQ(outcome.code, 128 + SIGPIPE) << words[0];
            EXPECT_EQ(outcome.err, "") << words[0];
        }
        EXPECT_EQ(shown(scratch, "s.rrec"), "");
    }
}

TEST(ProgramFiles, OutputOnAFullDiskIsASentence) {
    RunOptions full;
    full.stdoutFile = "/dev/full";
    const Outcome outcome = runProgram({"list"}, full);
    EXPECT_EQ(outcome.code, 1);
    EXPECT_EQ(outcome.err, "rivulet: the output cannot be written: the disk is full\n");
}

TEST(ProgramFiles, NoFolderForTemporaryFilesIsNeeded) {
    const Scratch scratch;
    scratch.file("s.json", smallScene());
    RunOptions options = in(scratch);
    for (const std::string folder : {"/nonexistent", "/proc", "s.json"}) {
        options.environment["TMPDIR"] = folder;
        const Outcome run = runProgram({"run", "s.json", "--headless", "--size", "64x48", "--frames", "2"}, options);
        EXPECT_EQ(run.code, 0) << run.err;
        const Outcome validated = runProgram({"validate", "rotating_patch", "--method", "pbf", "--quick", "--pictures", "p"}, options);
        EXPECT_EQ(validated.code, 0) << validated.err;
    }
}

// Nothing of the C++ library's own words, for every verb that needs memory.
TEST(ProgramFiles, LittleMemoryIsASentence) {
    if (kSanitized) GTEST_SKIP() << "a sanitizer reserves more than any limit";
    const Scratch scratch;
    scratch.file("s.json", R"({"name": "small", "fluid": {"spacing": 0.0025, "box": {"min": [0, 0, 0], "max": [0.4, 0.4, 0.4]},
        "blocks": [{"min": [0.05, 0.05, 0.05], "max": [0.35, 0.35, 0.35]}]}})");
    for (const rlim_t megabytes : {150, 250, 400}) {
        RunOptions options = in(scratch);
        options.before = [megabytes] {
            const rlimit limit{megabytes << 20U, megabytes << 20U};
            setrlimit(RLIMIT_AS, &limit);
        };
        for (const Words& words :
             {Words{"run", "s.json", "--no-render", "--backend", "cpu", "--frames", "1"},
              Words{"voxelize", RIVULET_SOURCE_DIR "/assets/meshes/paddle.obj", "--backend", "cpu", "--resolution", "512"},
              Words{"export", "s.json", "--backend", "cpu", "--format", "csv", "--surface", "obj", "--seconds", "0.01"}}) {
            const Outcome outcome = runProgram(words, options);
            EXPECT_TRUE(outcome.code == 0 || outcome.code == 1) << megabytes << " MiB: status " << outcome.code << ", " << outcome.err;
            for (const char* raw : {"bad_alloc", "std::", "terminate", "what()"})
                EXPECT_EQ(outcome.err.find(raw), std::string::npos) << megabytes << " MiB: " << outcome.err;
        }
    }
}

// No control character, valid text, short lines.
void expectPlain(const std::string& text, const Words& words) {
    size_t start = 0;
    for (size_t k = 0; k < text.size(); ++k) {
        const auto c = static_cast<unsigned char>(text[k]);
        EXPECT_TRUE(c == '\n' || (c >= 0x20 && c != 0x7F)) << words[0] << " printed byte " << int{c} << " at " << k << " of: " << text;
        EXPECT_TRUE(c != 0xFF) << words[0] << ": " << text;
        if (c != '\n') continue;
        EXPECT_LE(k - start, 500U) << words[0];
        start = k + 1;
    }
}

TEST(ProgramFiles, NamesDoNotControlTheTerminal) {
    const Scratch scratch;
    const std::string evil = "evil\x1b]0;owned\x07\n\x1b[31m\xFF";
    scratch.file(evil + ".json", R"({"name": "a\u001b[2Jb\nrivulet: c\u009b", "doc": "\u001b[31mred\u202e",
        "fluid": {"spacing": 0.02, "box": {"min": [0, 0, 0], "max": [0.4, 0.4, 0.4]}}})");
    fs::create_directory(scratch.path() / "scenes");
    fs::copy(scratch.path() / (evil + ".json"), scratch.path() / "scenes" / (evil + ".json"));
    scratch.file("scenes/wrong.json", R"({"\u001b[31m": 1})");
    scratch.file("mesh.json", smallScene(R"("colliders": [{"mesh": "\u001b[31mball.obj"}])"));
    std::string folders = scratch.path().string();
    while (folders.size() < 4000) folders += "/folder";
    size_t printed = 0;
    for (const Words& words :
         {Words{"run", evil + ".json", "--no-render", "--backend", "cpu", "--frames", "1", "--stats", evil + ".stats"},
          Words{"list", "scenes"}, Words{evil}, Words{"run", evil, "--no-render", "--backend", "cpu", "--frames", "1"},
          Words{"run", "s", "--" + evil}, Words{"run", "mesh.json", "--no-render", "--backend", "cpu"}, Words{"list", evil},
          Words{"run", evil + ".json", "--no-render", "--backend", "cpu", "--set", evil + "=1"},
          Words{"run", evil + ".json", "--no-render", "--backend", "cpu", "--preset", evil}, Words{"voxelize", evil},
          Words{"voxelize", evil + ".json"}, Words{"run", evil + ".json", "--no-render", "--backend", "cpu", "--resume", evil},
          Words{"run", evil + ".json", "--no-render", "--backend", "cpu", "--stats", evil + "/x"},
          Words{"export", evil + ".json", "--backend", "cpu", "--format", "csv", "--seconds", "0.02", "--out", evil},
          Words{"run", folders + "/pond.json"}, Words{"voxelize", folders + "/pond.json"},
          Words{"run", evil + ".json", "--no-render", "--backend", "cpu", "--stats", folders + "/pond.json"},
          Words{"run", std::string(5000, 'x')},
          Words{"run", evil + ".json", "--no-render", "--backend", "cpu", "--frames", std::string(5000, '9')}}) {
        const Outcome outcome = runProgram(words, in(scratch));
        expectPlain(outcome.out, words);
        expectPlain(outcome.err, words);
        printed += outcome.out.size() + outcome.err.size();
        if (words.back().ends_with("pond.json")) EXPECT_NE(outcome.err.find("/pond.json"), std::string::npos) << outcome.err;
    }
    EXPECT_GT(printed, 1000U);
}

}  // namespace
}  // namespace rivulet::testing::program_files_test
