// What a reader that was taken over can still do: read the model's folder, compute, and answer.
#include "engine/scene/import/sandbox.h"

#include <gtest/gtest.h>

#include <fcntl.h>
#include <linux/landlock.h>
#include <linux/seccomp.h>
#include <sys/ptrace.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <functional>

#include "engine/core/sanitized.h"
#include "tests/unit/program_runner.h"

namespace rivulet::testing::import_sandbox_test {
namespace {

namespace fs = std::filesystem;

// The names of the attempts that succeed in a confined process, or "unconfined".
std::string succeeded(const fs::path& root) {
    std::array<int, 2> ends{};
    EXPECT_EQ(::pipe(ends.data()), 0);
    const std::string folder = root / "model", inside = root / "model/a.obj", link = root / "elsewhere.obj", outside = root / "outside",
                      fresh = root / "model/new", moved = root / "model/b.obj";
    const pid_t child = ::fork();
    if (child == 0) {
        limitProcess(size_t{4} << 30U, 10);
        const Confinement confined = confine(folder, link);
        const auto opens = [](const std::string& path, int flags) { return ::open(path.c_str(), flags, 0600) >= 0; };
        char program[] = "/bin/true";
        char* const words[] = {program, nullptr};
        const struct {
            const char* name;
            std::function<bool()> attempt;
        } attempts[] = {
            {"inside ", [&] { return opens(inside, O_RDONLY); }},
            {"model ", [&] { return opens(link, O_RDONLY); }},
            {"memory ", [] { return std::vector<char>(1 << 24).size() > 0; }},
            {"outside ", [&] { return opens(outside, O_RDONLY); }},
            {"passwd ", [&] { return opens("/etc/passwd", O_RDONLY); }},
            {"write ", [&] { return opens(inside, O_WRONLY); }},
            {"both ", [&] { return opens(inside, O_RDWR); }},
            {"truncate ", [&] { return opens(inside, O_RDONLY | O_TRUNC); }},
            {"create ", [&] { return opens(fresh, O_RDONLY | O_CREAT); }},
            {"unlink ", [&] { return ::unlink(inside.c_str()) == 0; }},
            {"rename ", [&] { return ::rename(inside.c_str(), moved.c_str()) == 0; }},
            {"chmod ", [&] { return ::chmod(inside.c_str(), 0777) == 0; }},
            {"socket ", [] { return ::socket(AF_INET, SOCK_STREAM, 0) >= 0; }},
            {"pair ",
             [] {
                 int pair[2];
                 return ::socketpair(AF_UNIX, SOCK_STREAM, 0, pair) == 0;
             }},
            {"signal ", [] { return ::kill(::getppid(), 0) == 0; }},
            {"trace ", [] { return ::ptrace(PTRACE_SEIZE, ::getppid(), nullptr, nullptr) == 0; }},
            {"limits ",
             [] {
                 struct rlimit limit {};
                 return ::prlimit(::getppid(), RLIMIT_NOFILE, nullptr, &limit) == 0;
             }},
            {"fork ",
             [] {
                 const pid_t more = ::fork();
                 if (more == 0) ::_exit(0);
                 return more > 0;
             }},
            {"exec ", [&] { return ::execve(program, words, nullptr) == 0; }},
        };
        std::string names = confined.files && confined.calls ? "" : "unconfined ";
        for (const auto& a : attempts)
            if (a.attempt()) names += a.name;
        (void)!::write(ends[1], names.data(), names.size());
        ::_exit(0);
    }
    ::close(ends[1]);
    std::string names(4096, '\0');
    const ssize_t got = ::read(ends[0], names.data(), names.size());
    ::close(ends[0]);
    int status = 0;
    EXPECT_EQ(::waitpid(child, &status, 0), child);
    EXPECT_EQ(status, 0);
    names.resize(static_cast<size_t>(std::max<ssize_t>(got, 0)));
    return names;
}

// The status of a process that limits itself and then does `work`.
int statusOf(size_t memory, int seconds, const std::function<int()>& work) {
    const pid_t child = ::fork();
    if (child == 0) {
        limitProcess(memory, seconds);
        ::_exit(work());
    }
    int status = 0;
    EXPECT_EQ(::waitpid(child, &status, 0), child);
    return status;
}

TEST(ImportSandbox, AReaderThatComputesForEverIsEnded) {
    const int status = statusOf(size_t{4} << 30U, 1, [] {
        volatile bool more = true;
        while (more) {
        }
        return 0;
    });
    ASSERT_TRUE(WIFSIGNALED(status));
    EXPECT_EQ(WTERMSIG(status), SIGXCPU);
}

TEST(ImportSandbox, MemoryAndTimeGrowWithTheFilesThatAreRead) {
    constexpr size_t kMiB = size_t{1} << 20U;
    const auto limitsAfter = [](size_t bytes) {
        return [bytes] {
            struct rlimit memory {
            }, seconds{};
            allowFor(bytes);
            (void)::getrlimit(RLIMIT_AS, &memory);
            (void)::getrlimit(RLIMIT_CPU, &seconds);
            const bool asGiven = memory.rlim_cur == RLIM_INFINITY ||
                                 memory.rlim_cur == std::min(2048 * kMiB + 64 * std::min(bytes, 16384 * kMiB), 16384 * kMiB);
            return asGiven && seconds.rlim_cur == std::min<rlim_t>(20 + bytes / 1'000'000, 600) ? 0 : 1;
        };
    };
    for (const size_t bytes : {size_t{0}, size_t{1} << 20U, size_t{100} << 20U, size_t{1} << 40U, SIZE_MAX / 2})
        EXPECT_EQ(statusOf(2048 * kMiB, 20, limitsAfter(bytes)), 0) << bytes;
    // Beyond the limit there is no memory. A build with sanitizers has none.
    const int status = statusOf(1024 * kMiB, 20, [] {
        struct rlimit limit {};
        (void)::getrlimit(RLIMIT_AS, &limit);
        if (limit.rlim_cur == RLIM_INFINITY) return 0;
        void* const much = std::malloc(2048 * kMiB);
        const bool refused = much == nullptr;
        std::free(much);
        return refused ? 0 : 1;
    });
    EXPECT_EQ(status, 0);
}

// Asked of the kernel itself, so that a confinement that stopped working fails and is not skipped.
bool kernelConfines() {
    const bool landlock = ::syscall(SYS_landlock_create_ruleset, nullptr, 0, LANDLOCK_CREATE_RULESET_VERSION) > 0;
    const uint32_t action = SECCOMP_RET_ERRNO;
    return landlock && ::syscall(SYS_seccomp, SECCOMP_GET_ACTION_AVAIL, 0, &action) == 0;
}

TEST(ImportSandbox, AConfinedProcessReadsTheFolderOfTheModelAndNothingElse) {
    if (kSanitized) GTEST_SKIP() << "builds with sanitizers are not confined";
    const Scratch scratch;
    fs::create_directories(scratch.path() / "model");
    (void)scratch.file("model/a.obj", "text");
    (void)scratch.file("elsewhere.obj", "text");
    (void)scratch.file("outside", "text");
    const std::string names = succeeded(scratch.path());
    if (names.starts_with("unconfined") && !kernelConfines()) GTEST_SKIP() << "this kernel has no Landlock or no seccomp";
    EXPECT_EQ(names, "inside model memory ");
}

}  // namespace
}  // namespace rivulet::testing::import_sandbox_test
