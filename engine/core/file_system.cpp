#include "engine/core/file_system.h"

#include <fcntl.h>
#include <linux/magic.h>
#include <sys/stat.h>
#include <sys/statfs.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <memory>

namespace rivulet {

namespace {

// Their files have no size, and reading them may wait, have effects or show what the user must not pass on.
bool isVirtualSystem(long fileSystem) {
    constexpr long kVirtual[] = {PROC_SUPER_MAGIC, SYSFS_MAGIC,        DEBUGFS_MAGIC,       TRACEFS_MAGIC,
                                 SECURITYFS_MAGIC, CGROUP_SUPER_MAGIC, CGROUP2_SUPER_MAGIC, BPF_FS_MAGIC};
    return std::find(std::begin(kVirtual), std::end(kVirtual), fileSystem) != std::end(kVirtual);
}

FileFacts::Kind kindOf(mode_t mode) {
    using enum FileFacts::Kind;
    if (S_ISREG(mode)) return regular;
    if (S_ISDIR(mode)) return folder;
    if (S_ISFIFO(mode)) return pipe;
    return S_ISSOCK(mode) ? socket : device;
}

FileFacts factsOf(int failed, const struct stat& facts) {
    if (failed != 0) return {.error = errno};
    return {.kind = kindOf(facts.st_mode),
            .bytes = static_cast<uint64_t>(facts.st_size),
            .mode = facts.st_mode & 07777U,
            .device = facts.st_dev,
            .number = facts.st_ino,
            .changed = static_cast<uint64_t>(facts.st_mtim.tv_sec) * 1'000'000'000U + static_cast<uint64_t>(facts.st_mtim.tv_nsec)};
}

int errorOf(int failed) { return failed == 0 ? 0 : errno; }

}  // namespace

FileFacts factsOf(const std::string& path) {
    struct stat facts = {};
    return factsOf(::stat(path.c_str(), &facts), facts);
}

FileFacts factsOf(const Descriptor& file) {
    struct stat status = {};
    FileFacts facts = factsOf(::fstat(file.get(), &status), status);
    struct statfs system = {};
    facts.isVirtual = ::fstatfs(file.get(), &system) == 0 && isVirtualSystem(static_cast<long>(system.f_type));
    return facts;
}

std::optional<std::string> followed(const std::string& path) {
    const std::unique_ptr<char, void (*)(void*)> whole(::realpath(path.c_str(), nullptr), std::free);
    return whole ? std::optional<std::string>(whole.get()) : std::nullopt;
}

int mayWrite(const std::string& path) { return errorOf(::access(path.c_str(), W_OK)); }

int replaceFile(const std::string& from, const std::string& to) { return errorOf(::rename(from.c_str(), to.c_str())); }

int nameFile(const std::string& from, const std::string& to) {
    // A hard link fails if the name is taken, at whatever moment; some file systems have none.
    if (::link(from.c_str(), to.c_str()) != 0) return errno;
    (void)::unlink(from.c_str());
    return 0;
}

void removeFile(const char* path) noexcept { (void)::unlink(path); }

int setMode(const Descriptor& file, unsigned mode) { return errorOf(::fchmod(file.get(), mode)); }

int syncToDisk(const Descriptor& file) { return errorOf(::fsync(file.get())); }

void syncFolderOf(const std::string& path) {
    const std::filesystem::path folder = std::filesystem::path(path).parent_path();
    const Descriptor at = openDescriptor(folder.empty() ? "." : folder.string(), O_RDONLY | O_DIRECTORY);
    if (at.valid()) (void)::fsync(at.get());
}

Descriptor duplicateOf(int descriptor) { return Descriptor(::fcntl(descriptor, F_DUPFD_CLOEXEC, STDERR_FILENO + 1)); }

std::ptrdiff_t writeSome(const Descriptor& file, const void* from, size_t bytes) {
    for (;;) {
        const ssize_t written = ::write(file.get(), from, bytes);
        if (written >= 0 || errno != EINTR) return written;
    }
}

std::ptrdiff_t readAt(const Descriptor& file, void* to, size_t bytes, uint64_t at) {
    for (;;) {
        const ssize_t got = ::pread(file.get(), to, bytes, static_cast<off_t>(at));
        if (got >= 0 || errno != EINTR) return got;
    }
}

ProcessId processId() noexcept { return ::getpid(); }

}  // namespace rivulet
