// Limits of Linux for a process: setrlimit, Landlock, seccomp.
#include "engine/scene/import/sandbox.h"

#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/landlock.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/core/sanitized.h"

namespace rivulet {
namespace {

constexpr rlim_t kMostMemory = rlim_t{16} << 30U, kMostSeconds = 600, kFiles = 32;
constexpr rlim_t kMemoryPerByte = 64, kBytesPerSecond = 1'000'000;

void setLimit(int what, rlim_t soft, rlim_t hard) {
    struct rlimit limit {};
    (void)::getrlimit(static_cast<__rlimit_resource>(what), &limit);
    limit.rlim_max = std::min(limit.rlim_max, hard);
    limit.rlim_cur = std::min(limit.rlim_max, soft);
    (void)::setrlimit(static_cast<__rlimit_resource>(what), &limit);
}

void raiseLimit(int what, rlim_t by) {
    struct rlimit limit {};
    (void)::getrlimit(static_cast<__rlimit_resource>(what), &limit);
    limit.rlim_cur += std::min(by, limit.rlim_max - limit.rlim_cur);
    (void)::setrlimit(static_cast<__rlimit_resource>(what), &limit);
}

// The kernel opens only what lies in the folder, and the file.
bool confineFiles(const std::string& folder, const std::string& file) {
    landlock_ruleset_attr rules{};
    constexpr uint64_t kAll = (uint64_t{1} << 13U) - 1;  // of the first version of Landlock: reading, writing, making, removing, running
    rules.handled_access_fs = kAll;
    const auto ruleset = static_cast<int>(::syscall(SYS_landlock_create_ruleset, &rules, sizeof rules, 0));
    if (ruleset < 0) return false;
    const auto allow = [ruleset](const std::string& path, uint64_t access) {
        landlock_path_beneath_attr rule{};
        rule.allowed_access = access;
        rule.parent_fd = ::open(path.c_str(), O_PATH | O_CLOEXEC);
        const bool added = rule.parent_fd >= 0 && ::syscall(SYS_landlock_add_rule, ruleset, LANDLOCK_RULE_PATH_BENEATH, &rule, 0) == 0;
        if (rule.parent_fd >= 0) ::close(rule.parent_fd);
        return added;
    };
    const bool confined = allow(folder, LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_READ_DIR) &&
                          allow(file, LANDLOCK_ACCESS_FS_READ_FILE) && ::syscall(SYS_landlock_restrict_self, ruleset, 0) == 0;
    ::close(ruleset);
    return confined;
}

#if defined(__x86_64__)
constexpr uint32_t kArchitecture = AUDIT_ARCH_X86_64;
#elif defined(__aarch64__)
constexpr uint32_t kArchitecture = AUDIT_ARCH_AARCH64;
#else
constexpr uint32_t kArchitecture = 0;
#endif

// The calls of a reader. Any other fails with EPERM.
constexpr uint32_t kCalls[] = {
    SYS_read,           SYS_readv,        SYS_pread64,     SYS_write,       SYS_writev,        SYS_close,
    SYS_fstat,          SYS_fstatfs,      SYS_newfstatat,  SYS_statx,       SYS_lseek,         SYS_readlinkat,
    SYS_faccessat,      SYS_faccessat2,   SYS_getcwd,      SYS_getdents64,  SYS_mmap,          SYS_munmap,
    SYS_mremap,         SYS_mprotect,     SYS_madvise,     SYS_brk,         SYS_futex,         SYS_rt_sigaction,
    SYS_rt_sigprocmask, SYS_rt_sigreturn, SYS_sigaltstack, SYS_getrandom,   SYS_clock_gettime, SYS_gettimeofday,
    SYS_getpid,         SYS_gettid,       SYS_uname,       SYS_sched_yield, SYS_exit,          SYS_exit_group,
#if defined(__x86_64__)
    SYS_stat,           SYS_lstat,        SYS_readlink,    SYS_access,      SYS_getrlimit,     SYS_setrlimit,
#endif
};

// A program of classic BPF, which the kernel runs at each call.
bool confineCalls() {
    if (kArchitecture == 0) return false;
    std::vector<sock_filter> program;
    const auto load = [&program](size_t at) { program.push_back(BPF_STMT(BPF_LD | BPF_W | BPF_ABS, static_cast<uint32_t>(at))); };
    const auto end = [&program](uint32_t with) { program.push_back(BPF_STMT(BPF_RET | BPF_K, with)); };
    // Continues with the next statement if the number loaded equals `value`, else after `skip` statements.
    const auto ifEqual = [&program](uint32_t value, uint8_t skip) {
        program.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, value, 0, skip));
    };
    const auto argument = [](size_t k) { return offsetof(seccomp_data, args) + k * sizeof(uint64_t); };  // its lower half: little-endian
    constexpr uint32_t kRefuse = SECCOMP_RET_ERRNO | EPERM;
    load(offsetof(seccomp_data, arch));
    program.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, kArchitecture, 1, 0));
    end(kRefuse);
    load(offsetof(seccomp_data, nr));
    ifEqual(SYS_openat, 4);  // for reading
    load(argument(2));
    program.push_back(BPF_JUMP(BPF_JMP | BPF_JSET | BPF_K, O_WRONLY | O_RDWR | O_CREAT | O_TRUNC, 0, 1));
    end(kRefuse);
    end(SECCOMP_RET_ALLOW);
    ifEqual(SYS_prlimit64, 4);  // of this process
    load(argument(0));
    ifEqual(0, 1);
    end(SECCOMP_RET_ALLOW);
    end(kRefuse);
    for (const uint32_t call : kCalls) {
        ifEqual(call, 1);
        end(SECCOMP_RET_ALLOW);
    }
    end(kRefuse);
    const sock_fprog filter{static_cast<unsigned short>(program.size()), program.data()};
    return ::prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &filter) == 0;
}

}  // namespace

void limitProcess(size_t memory, int seconds) {
    (void)::prctl(PR_SET_PDEATHSIG, SIGKILL);
    setLimit(RLIMIT_CORE, 0, 0);
    setLimit(RLIMIT_FSIZE, 0, 0);
    setLimit(RLIMIT_NOFILE, kFiles, kFiles);
    constexpr rlim_t kSlower = kSanitized ? 10 : 1;
    setLimit(RLIMIT_CPU, kSlower * static_cast<rlim_t>(seconds), kSlower * kMostSeconds);
    if (!kSanitized) setLimit(RLIMIT_AS, memory, kMostMemory);
}

void allowFor(size_t bytes) {
    raiseLimit(RLIMIT_CPU, bytes / kBytesPerSecond);
    if (!kSanitized) raiseLimit(RLIMIT_AS, std::min<rlim_t>(bytes, kMostMemory) * kMemoryPerByte);
}

size_t memoryLimit() {
    struct rlimit limit {};
    return ::getrlimit(RLIMIT_AS, &limit) == 0 ? limit.rlim_cur : 0;
}

Confinement confine(const std::string& folder, const std::string& file) {
    if (kSanitized || ::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) return {};
    const bool files = confineFiles(folder, file);
    return {files, confineCalls()};
}

}  // namespace rivulet
