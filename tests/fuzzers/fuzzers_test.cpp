// Every fuzz target returns for its seeds, for bytes that failed once, and for mutations of both: bits that flip, bytes cut out, put in,
// repeated and taken from another input. A failure prints the bytes as a file, which `bash tests/fuzz.sh NAME FILE` runs again.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <random>

#include "tests/fuzzers/target.h"

namespace rivulet::fuzzers_test {
namespace {

using fuzzers::Target;

std::vector<std::string> finds(const std::string& name) {
    std::vector<std::string> all;
    const std::filesystem::path folder = std::filesystem::path(RIVULET_SOURCE_DIR) / "tests" / "fuzzers" / "finds" / name;
    if (!std::filesystem::exists(folder)) return all;
    for (const auto& file : std::filesystem::directory_iterator(folder)) all.push_back(fuzzers::contentsOf(file.path()));
    return all;
}

std::string mutated(std::string bytes, const std::vector<std::string>& all, std::mt19937& random) {
    const auto below = [&random](size_t count) { return count == 0 ? 0 : static_cast<size_t>(random()) % count; };
    for (size_t k = 0, count = 1 + below(6); k < count; ++k) {
        const size_t at = below(bytes.size());
        switch (below(7)) {
            case 0:
                if (!bytes.empty()) bytes[at] = static_cast<char>(bytes[at] ^ static_cast<char>(1U << below(8)));
                break;
            case 1:
                if (!bytes.empty()) bytes[at] = static_cast<char>(random());
                break;
            case 2:
                bytes.erase(at, below(16));
                break;
            case 3:
                bytes.insert(at, std::string(below(8), static_cast<char>(random())));
                break;
            case 4:
                bytes.insert(at, bytes.substr(at, below(64)));
                break;
            case 5: {
                const std::string& other = all[below(all.size())];
                bytes.replace(at, below(32), other.substr(below(other.size()), below(32)));
                break;
            }
            default: {
                constexpr std::array<uint32_t, 6> kWords = {0, 1, 0x7fffffffU, 0x80000000U, 0xffffffffU, 0x7fc00000U};
                const uint32_t word = kWords[below(kWords.size())];
                if (bytes.size() >= sizeof word)
                    bytes.replace(std::min(at, bytes.size() - sizeof word), sizeof word, reinterpret_cast<const char*>(&word), sizeof word);
            }
        }
    }
    return bytes;
}

class Fuzzers : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Targets, Fuzzers, testing::ValuesIn([] {
                             std::vector<std::string> names;
                             for (const Target& t : fuzzers::targets()) names.emplace_back(t.name);
                             return names;
                         }()),
                         [](const auto& of) { return of.param; });

TEST_P(Fuzzers, ReturnsForSeedsFindsAndMutations) {
    const Target* target = fuzzers::findTarget(GetParam());
    ASSERT_NE(target, nullptr);
    // In a process of its own, which leaves what it is at in a file: a crash is a failure of this test alone.
    const std::string at = (std::filesystem::path(testing::TempDir()) / fmt::format("fuzz_{}_{}", GetParam(), getpid())).string();
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
        std::vector<std::string> all = target->seeds();
        fuzzers::require(!all.empty(), "a target has seeds");
        for (std::string& find : finds(GetParam())) all.push_back(std::move(find));
        const size_t given = all.size();
        std::mt19937 random(1);
        for (int k = 0; k < target->mutations; ++k) all.push_back(mutated(all[static_cast<size_t>(random()) % given], all, random));
        for (const std::string& bytes : all) {
            {
                std::ofstream file(at, std::ios::binary);
                file << bytes;
            }
            constexpr itimerval kMostProcessorTime{{0, 0}, {30, 0}};  // s; then SIGPROF ends the process
            (void)setitimer(ITIMER_PROF, &kMostProcessorTime, nullptr);
            target->run(fuzzers::bytesOf(bytes));
        }
        _exit(0);
    }
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0)
        << (WIFSIGNALED(status) ? fmt::format("signal {}", WTERMSIG(status)) : fmt::format("exit status {}", WEXITSTATUS(status))) << ": "
        << at;
    if (!testing::Test::HasFailure()) std::filesystem::remove(at);
}

}  // namespace
}  // namespace rivulet::fuzzers_test
