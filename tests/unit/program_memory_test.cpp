// A run under a limit of the process's memory ends with a sentence, wherever the limit is: never by a signal, and never without steps.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "engine/core/sanitized.h"
#include "tests/unit/program_runner.h"

namespace rivulet::testing::program_memory_test {
namespace {

// On one core, so that the memory of threads is the same on every machine.
Outcome limited(long kilobytes, const std::vector<std::string>& arguments, const RunOptions& options) {
    std::vector<std::string> words = {"bash", "-c", fmt::format("ulimit -v {}; exec taskset -c 0 \"$0\" \"$@\"", kilobytes),
                                      RIVULET_PROGRAM};
    words.insert(words.end(), arguments.begin(), arguments.end());
    return runCommand(words, options);
}

// 280,000 particles. The limits lie on both sides of what they need.
TEST(ProgramMemory, ARunUnderALimitEndsWithASentence) {
    if (kSanitized) GTEST_SKIP() << "a sanitizer reserves more than any limit";
    Scratch scratch;
    RunOptions options = in(scratch);
    if (runCommand({"taskset", "-c", "0", "true"}, options).code != 0) GTEST_SKIP() << "taskset is not there";
    const std::string scene =
        scratch.file("large.json", R"({"name": "large", "fluid": {"spacing": 0.015, "maxSubsteps": 2, "pbf": {"iterations": 1},
            "box": {"max": [1.6, 1, 1]}, "blocks": [{"max": [1.2, 0.8, 1], "jitter": 0}]}})");
    long least = 64 << 10;  // kB: the program starts
    while (limited(least, {"list", "methods"}, options).code != 0 && least < 8 << 20) least += 32 << 10;
    int refused = 0;
    for (const long more : {0L, 16L, 32L, 48L, 64L, 96L, 128L, 192L}) {
        const Outcome run = limited(least + (more << 10), {"run", scene, "--no-render", "--frames", "2", "--backend", "cpu"}, options);
        ASSERT_TRUE(run.code == 0 || run.code == 1) << more << " MB: " << run.code << ' ' << run.err;
        if (run.code == 0) continue;
        ++refused;
        EXPECT_NE(run.err.find("memory"), std::string::npos) << run.err;
    }
    EXPECT_GT(refused, 0);
}

}  // namespace
}  // namespace rivulet::testing::program_memory_test
