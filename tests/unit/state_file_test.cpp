// The file of a saved state gives back exactly its content, or one plain sentence, for any bytes. And `rivulet run --save, --resume`.
#include <gtest/gtest.h>
#include <xxhash.h>

#include <cstring>
#include <fstream>
#include <random>
#include <sstream>
#include <tuple>

#include "fluid/sim/world/world_state.h"
#include "tests/unit/program_runner.h"

namespace rivulet::testing::state_file_test {
namespace {

WorldState sample() {
    WorldState state;
    std::vector<float> noise(3000);
    std::mt19937 random(5);
    for (float& f : noise) f = std::uniform_real_distribution<float>(-1, 1)(random);
    state.put<float>("particles.position", noise);
    state.put<double>("world.numbers", std::vector<double>{0.1, 1e300, -0.0});
    state.put<uint32_t>("nothing", {});
    state.putText("world.params", "fluid.spacing = 0.02\n");
    return state;
}

std::string packed() {
    Result<std::string> bytes = packState(sample());
    EXPECT_TRUE(bytes);
    return *bytes;
}

std::string refusal(const std::string& bytes) {
    Result<WorldState> state = unpackState(std::as_bytes(std::span(bytes)), "a.rstate");
    if (state) return "";
    EXPECT_TRUE(state.error().message.starts_with("a.rstate: ")) << state.error().message;
    EXPECT_EQ(state.error().message.find('\n'), std::string::npos);
    return state.error().message;
}

TEST(StateFile, ReadsBackThePackedState) {
    const std::string bytes = packed();
    Result<WorldState> state = unpackState(std::as_bytes(std::span(bytes)), "a.rstate");
    ASSERT_TRUE(state) << state.error().message;
    EXPECT_EQ(state->sections(), sample().sections());
    EXPECT_EQ(bytes, packed());
    Result<std::vector<double>> numbers = state->take<double>("world.numbers", 3);
    ASSERT_TRUE(numbers);
    EXPECT_EQ((*numbers)[1], 1e300);
    EXPECT_TRUE(std::signbit((*numbers)[2]));
    EXPECT_FALSE(state->take<double>("world.numbers", 3)) << "taken once";
    EXPECT_FALSE(state->take<float>("particles.position", 2999));
    EXPECT_FALSE(state->allTaken());
    EXPECT_EQ(*state->takeText("world.params"), "fluid.spacing = 0.02\n");
    EXPECT_TRUE(state->take<uint32_t>("nothing", 0));
    EXPECT_TRUE(state->allTaken()) << "what was of another size is taken, and refused";
    WorldState empty;
    Result<std::string> none = packState(empty);
    ASSERT_TRUE(none);
    EXPECT_TRUE(unpackState(std::as_bytes(std::span(*none)), "a.rstate"));
}

TEST(StateFile, EveryTruncationIsRefused) {
    const std::string bytes = packed();
    for (size_t length = 0; length < bytes.size(); length += length < 400 ? 1 : 37)
        EXPECT_NE(refusal(bytes.substr(0, length)), "") << length;
    EXPECT_NE(refusal(bytes + "x"), "");
}

TEST(StateFile, EveryFlippedBitIsRefused) {
    const std::string bytes = packed();
    for (size_t at = 0; at < bytes.size(); at += at < 400 ? 1 : 11)
        for (int bit = 0; bit < 8; bit += at < 400 ? 1 : 3) {
            std::string flipped = bytes;
            flipped[at] = static_cast<char>(flipped[at] ^ (1 << bit));
            EXPECT_NE(refusal(flipped), "") << at << " " << bit;
        }
    std::string version = bytes;
    version[12] = 9;
    EXPECT_NE(refusal(version).find("version is 9"), std::string::npos) << refusal(version);
}

// With the header's checksum made right again, the table is still not believed.
TEST(StateFile, AWrongTableIsRefused) {
    const std::string bytes = packed();
    std::mt19937 random(11);
    for (int k = 0; k < 400; ++k) {
        std::string lie = bytes;
        const size_t tableBytes = 4 * 64, at = 40 + random() % tableBytes;
        lie[at] = static_cast<char>(random());
        if (lie == bytes) continue;
        std::string head = lie.substr(0, 32) + lie.substr(40, tableBytes);
        const uint64_t sum = XXH3_64bits(head.data(), head.size());
        std::memcpy(lie.data() + 32, &sum, 8);
        const bool name = (at - 40) % 64 < 32;
        if (!name) EXPECT_NE(refusal(lie), "") << at;
        if (name) (void)refusal(lie);  // another name may be one: the world that takes the sections refuses it
    }
}

TEST(StateFile, FixedValuesThatDifferAreNamed) {
    EXPECT_TRUE(sameFixedValues("a = 1\nb = 2\n", "a = 1\nb = 2\n"));
    const Status other = sameFixedValues("a = 1\nb = 2\n", "a = 1\nb = 3\n");
    ASSERT_FALSE(other);
    EXPECT_NE(other.error().message.find("b = 2, this scene has b = 3"), std::string::npos) << other.error().message;
    EXPECT_FALSE(sameFixedValues("a = 1\n", "a = 1\nb = 2\n"));
    EXPECT_FALSE(sameFixedValues("a = 1\nb = 2\n", "a = 1\n"));
    EXPECT_TRUE(sameFixedValues("l.0.a = 1\nl.0.b = 2\n", "l.0.new = 7\nl.0.a = 1\nl.0.b = 2\n")) << "a parameter of a later version";
    EXPECT_FALSE(sameFixedValues("l.0.a = 1\nl.0.b = 2\n", "l.0.new = 7\nl.0.a = 1\nl.0.b = 3\n"));
    EXPECT_FALSE(sameFixedValues("l.0.a = 1\n", "l.0.a = 1\nl.1.a = 1\n")) << "another item";
    EXPECT_TRUE(sameFixedValues("a = 1\n", "new = 1 items\nnew.0.x = 2\na = 1\n")) << "a list of a later version";
    EXPECT_TRUE(sameFixedValues("l.0.a = 1\n", "l.0.new = 1 items\nl.0.new.0.x = 2\nl.0.a = 1\n")) << "in an item";
    EXPECT_FALSE(sameFixedValues("new = 0 items\na = 1\n", "new = 1 items\nnew.0.x = 2\na = 1\n"));
    EXPECT_TRUE(sameFixedValues("f.a = 1\n", "f.a = 1\nf.new.on = false\n")) << "a group of a later version";
    EXPECT_TRUE(sameFixedValues("f.a = 1\n", "f.a = 1\nnew.on = false\n"));
    EXPECT_TRUE(sameFixedValues("f.l.0.a = 1\n", "f.l.0.a = 1\nf.l.0.new.on = false\n")) << "in an item";
}

std::string textOf(const std::filesystem::path& path) {
    std::ifstream stream(path, std::ios::binary);
    std::ostringstream text;
    text << stream.rdbuf();
    return text.str();
}

TEST(ProgramState, TwiceNFramesAreNFramesTwice) {
    const Scratch scratch;
    const RunOptions in{.folder = scratch.path(), .environment = {}, .whileRunning = {}, .stdoutFile = {}};
    const std::string scene = scratch.file("small.json", smallScene());
    const std::vector<std::string> run = {"run",     scene,    "--no-render", "--backend",         "cpu",
                                          "--stats", "s.json", "--set",       "fluid.method=dfsph"};
    const auto with = [&](std::vector<std::string> more) {
        more.insert(more.begin(), run.begin(), run.end());
        return runProgram(more, in);
    };
    ASSERT_EQ(with({"--frames", "8", "--save", "whole.rstate"}).code, 0);
    ASSERT_EQ(with({"--frames", "4", "--save", "half.rstate"}).code, 0);
    const Outcome rest = with({"--frames", "4", "--resume", "half.rstate", "--save", "rest.rstate"});
    ASSERT_EQ(rest.code, 0) << rest.err;
    EXPECT_EQ(rest.err, "");
    EXPECT_NE(rest.out.find("rest.rstate"), std::string::npos) << rest.out;
    EXPECT_EQ(textOf(scratch.path() / "whole.rstate"), textOf(scratch.path() / "rest.rstate"));
    EXPECT_NE(textOf(scratch.path() / "whole.rstate"), textOf(scratch.path() / "half.rstate"));
    // Without --frames: to the scene's end.
    ASSERT_EQ(with({"--resume", "half.rstate", "--save", "end.rstate"}).code, 0);
    ASSERT_EQ(with({"--save", "all.rstate"}).code, 0);
    EXPECT_EQ(textOf(scratch.path() / "end.rstate"), textOf(scratch.path() / "all.rstate"));
}

// With bodies on Bullet, and with emitters and a sink: a duck on a box, and the shipped fountain, coarser.
TEST(ProgramState, BodiesEmittersAndSinksContinueToo) {
    const Scratch scratch;
    const std::string duck = scratch.file("duck.json", R"({
        "name": "duck", "duration": 1,
        "fluid": {"method": "dfsph", "box": {"min": [0, 0, 0], "max": [0.6, 0.6, 0.6]},
                  "blocks": [{"min": [0, 0, 0], "max": [0.6, 0.15, 0.6]}]},
        "bodies": [{"shape": "box", "size": [0.2, 0.15, 0.2], "position": [0.3, 0.08, 0.3], "density": 2000},
                   {"shape": "mesh", "mesh": "meshes/duck.obj", "fitSize": 0.15, "position": [0.3, 0.24, 0.3], "density": 260}]})");
    const RunOptions in{.folder = scratch.path(), .environment = {}, .whileRunning = {}, .stdoutFile = {}};
    const auto with = [&](const std::string& scene, const std::string& spacing, std::vector<std::string> more) {
        const std::vector<std::string> run = {"run",
                                              scene == "duck" ? duck : "scenes/" + scene + ".json",
                                              "--no-render",
                                              "--backend",
                                              "cpu",
                                              "--stats",
                                              "s.json",
                                              "--set",
                                              "fluid.spacing=" + spacing};
        more.insert(more.begin(), run.begin(), run.end());
        return runProgram(more, in);
    };
    const auto refused = [&](const std::string& state, const std::string& mentions) {
        const Outcome outcome = with("fountain", "0.025", {"--frames", "1", "--resume", state});
        EXPECT_EQ(outcome.code, 2) << state;
        EXPECT_NE(outcome.err.find(mentions), std::string::npos) << outcome.err;
    };
    for (const auto& [scene, spacing, frames] : {std::tuple("duck", "0.04", 8), std::tuple("fountain", "0.025", 20)}) {
        const std::string all = std::to_string(2 * frames), half = std::to_string(frames), file = std::string(scene) + ".rstate";
        ASSERT_EQ(with(scene, spacing, {"--frames", all, "--save", "whole.rstate"}).code, 0) << scene;
        ASSERT_EQ(with(scene, spacing, {"--frames", half, "--save", file}).code, 0) << scene;
        const Outcome rest = with(scene, spacing, {"--frames", half, "--resume", file, "--save", "rest.rstate"});
        ASSERT_EQ(rest.code, 0) << rest.err;
        EXPECT_TRUE(textOf(scratch.path() / "whole.rstate") == textOf(scratch.path() / "rest.rstate")) << scene;
        EXPECT_FALSE(textOf(scratch.path() / "whole.rstate") == textOf(scratch.path() / file)) << scene;
    }
    std::string bytes = textOf(scratch.path() / "fountain.rstate");
    scratch.file("cut.rstate", bytes.substr(0, bytes.size() / 2));
    bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
    scratch.file("changed.rstate", bytes);
    refused("cut.rstate", "cut off");
    refused("changed.rstate", "damaged");
    refused("duck.rstate", "resume it with the scene it was saved from");
}

TEST(ProgramState, RefusalsArePlain) {
    const Scratch scratch;
    const RunOptions in{.folder = scratch.path(), .environment = {}, .whileRunning = {}, .stdoutFile = {}};
    const std::string scene = scratch.file("small.json", smallScene());
    const auto with = [&](std::vector<std::string> more) {
        const std::vector<std::string> run = {"run", scene, "--no-render", "--backend", "cpu", "--stats", "s.json", "--frames", "1"};
        more.insert(more.begin(), run.begin(), run.end());
        return runProgram(more, in);
    };
    ASSERT_EQ(with({"--save", "a.rstate"}).code, 0);
    scratch.file("cut.rstate", textOf(scratch.path() / "a.rstate").substr(0, 900));
    scratch.file("text.rstate", "{}\n");
    expectRefusal(with({"--resume", "none.rstate"}), 2, "none.rstate");
    expectRefusal(with({"--resume", "cut.rstate"}), 2, "cut off");
    expectRefusal(with({"--resume", "text.rstate"}), 2, "not the beginning");
    expectRefusal(with({"--resume", scratch.path().string()}), 2, scratch.path().string());
    expectRefusal(with({"--resume", "a.rstate", "--set", "fluid.spacing=0.021"}), 2,
                  "fluid.spacing = 0.02, this scene has fluid.spacing = 0.021");
    expectRefusal(with({"--resume", ""}), 2, "--resume");
    expectRefusal(with({"--save", "none/a.rstate"}), 1, "none/a.rstate");
    expectRefusal(with({"--save", "text.rstate/a.rstate"}), 1, "text.rstate/a.rstate");
    expectRefusal(with({"--save", "/dev/full"}), 1, "/dev/full");
    EXPECT_EQ(textOf(scratch.path() / "a.rstate").substr(1, 4), "RSTA");
    for (const std::string& name : scratch.contents()) EXPECT_TRUE(name[0] != '.') << "left over: " << name;
}

}  // namespace
}  // namespace rivulet::testing::state_file_test
