// On the cpu the same scene gives the same bits: with each instruction set, on one core and on all, in another process, and when a run is
// saved and resumed. The hashes below are of one build; another compiler must give them too. A change of a kernel changes them: then the
// failure prints the new ones, which belong into the same commit.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <xxhash.h>

#include "engine/compute/device_cpu.h"
#include "fluid/sim/world/world_state.h"
#include "tests/unit/program_runner.h"

namespace rivulet::program_determinism_test {
namespace {

using testing::Outcome;
using testing::RunOptions;
using testing::runProgram;
using testing::Scratch;

// Ten seconds of a block that falls onto a floor beside a ball, an emitter and a sink.
std::string sceneOf(const std::string& method) {
    return fmt::format(R"({{"name": "hash", "fluid": {{"method": "{}", "spacing": 0.05, "box": {{"max": [0.6, 0.6, 0.4]}},
        "blocks": [{{"min": [0, 0.1, 0], "max": [0.3, 0.4, 0.4]}}]}},
        "bodies": [{{"shape": "sphere", "radius": 0.07, "position": [0.4, 0.2, 0.2]}}],
        "emitters": [{{"position": [0.5, 0.5, 0.2], "litresPerSecond": 2, "stop": 4}}],
        "sinks": [{{"position": [0.6, 0, 0.2], "size": [0.1, 0.1, 0.2]}}]}})",
                       method);
}

// Of all that a step depends on; the text of the parameters is left out, which grows with every new one.
uint64_t hashOf(const std::string& path) {
    const Result<WorldState> state = readState(path);
    EXPECT_TRUE(state) << (state ? "" : state.error().message);
    uint64_t hash = 0;
    if (state)
        for (const auto& [name, bytes] : state->sections())
            if (name.find("params") == std::string::npos) hash = XXH3_64bits_withSeed(bytes.data(), bytes.size(), hash);
    return hash;
}

struct Expected {
    const char* method;
    uint64_t hash;
};
class Determinism : public ::testing::TestWithParam<Expected> {};
INSTANTIATE_TEST_SUITE_P(Methods, Determinism,
                         ::testing::Values(Expected{"dfsph", 0x1c8536f108e62f8d}, Expected{"pbf", 0x2c353d3616211ef9},
                                           Expected{"wcsph", 0xb8813b27c44874dc}),
                         [](const auto& of) { return std::string(of.param.method); });

TEST_P(Determinism, TheSameSceneGivesTheSameBits) {
    Scratch scratch;
    const std::string scene = scratch.file("hash.json", sceneOf(GetParam().method));
    const auto hash = [&](const char* name, const std::string& isa, const std::vector<std::string>& more = {}, bool oneCore = false) {
        RunOptions in;
        in.folder = scratch.path();
        in.environment["RIVULET_ISA"] = isa;
        std::vector<std::string> words = {"run", scene, "--backend", "cpu", "--no-render", "--save", name};
        if (more.empty()) words.insert(words.end(), {"--frames", "600"});
        words.insert(words.end(), more.begin(), more.end());
        Outcome outcome;
        if (oneCore) {
            words.insert(words.begin(), {"taskset", "--cpu-list", "0", RIVULET_PROGRAM});
            outcome = testing::runCommand(words, in);
        } else {
            outcome = runProgram(words, in);
        }
        EXPECT_EQ(outcome.code, 0) << outcome.err;
        return hashOf((scratch.path() / name).string());
    };
    const uint64_t best = hash("best", "");
    EXPECT_EQ(best, GetParam().hash) << fmt::format("{{\"{}\", {:#x}}}", GetParam().method, best);
    for (const Isa isa : {Isa::generic, Isa::avx2, Isa::avx512})
        if (isa <= bestIsa()) EXPECT_EQ(hash("other", isaName(isa)), best) << isaName(isa);
    EXPECT_EQ(hash("one", "", {}, true), best) << "on one core";
    hash("half", "", {"--frames", "300"});
    EXPECT_EQ(hash("whole", "", {"--frames", "300", "--resume", "half"}), best) << "saved after five seconds, and resumed";
}

// Without foam, bodies and emitters; with them additions are in an order that varies.
class DeterminismOfGpus : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Backends, DeterminismOfGpus, ::testing::Values("gl", "cl"), [](const auto& of) { return std::string(of.param); });

TEST_P(DeterminismOfGpus, ARunIsRepeated) {
    Scratch scratch;
    RunOptions in;
    in.folder = scratch.path();
    const std::string scene = scratch.file("small.json", testing::smallScene());
    uint64_t first = 0;
    for (const char* name : {"first", "second"}) {
        const Outcome outcome = runProgram({"run", scene, "--backend", GetParam(), "--no-render", "--frames", "30", "--save", name}, in);
        ASSERT_EQ(outcome.code, 0) << outcome.err;
        if (outcome.err.find("the cpu simulates") != std::string::npos) GTEST_SKIP() << outcome.err;
        const uint64_t hash = hashOf((scratch.path() / name).string());
        if (first == 0) first = hash;
        EXPECT_EQ(hash, first);
    }
}

TEST(Isa, OneThatIsNoneIsRefused) {
    Scratch scratch;
    RunOptions in;
    in.folder = scratch.path();
    in.environment["RIVULET_ISA"] = "sse";
    const std::string scene = scratch.file("small.json", testing::smallScene());
    testing::expectRefusal(runProgram({"run", scene, "--no-render", "--frames", "1"}, in), 2, "RIVULET_ISA");
}

}  // namespace
}  // namespace rivulet::program_determinism_test
