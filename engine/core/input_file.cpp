#include "engine/core/input_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <linux/magic.h>
#include <sys/stat.h>
#include <sys/statfs.h>

#include <algorithm>
#include <cerrno>
#include <iterator>
#include <string_view>

namespace rivulet {

namespace {

// "": a regular file.
std::string_view otherThanFile(mode_t mode) {
    if (S_ISREG(mode)) return "";
    if (S_ISDIR(mode)) return "it is a folder";
    if (S_ISFIFO(mode)) return "it is a pipe; write its data to a file first";
    if (S_ISSOCK(mode)) return "it is a socket; name a file";
    return "it is a device; name a file";
}

// Their files have no size, and reading them may wait, have effects or show what the user must not pass on.
bool isVirtual(long fileSystem) {
    constexpr long kVirtual[] = {PROC_SUPER_MAGIC, SYSFS_MAGIC,        DEBUGFS_MAGIC,       TRACEFS_MAGIC,
                                 SECURITYFS_MAGIC, CGROUP_SUPER_MAGIC, CGROUP2_SUPER_MAGIC, BPF_FS_MAGIC};
    return std::find(std::begin(kVirtual), std::end(kVirtual), fileSystem) != std::end(kVirtual);
}

}  // namespace

Result<Descriptor> openInput(const std::string& path) {
    const auto refused = [&](std::string_view why) { return badInput(fmt::format("{} cannot be read: {}", path, why)); };
    struct stat facts = {};
    if (::stat(path.c_str(), &facts) != 0) return refused(reasonOf(errno));
    if (const std::string_view other = otherThanFile(facts.st_mode); !other.empty()) return refused(other);  // opening it may have effects
    Descriptor file = openDescriptor(path, O_RDONLY | O_NONBLOCK | O_NOCTTY);
    if (!file.valid()) return refused(reasonOf(errno));
    if (::fstat(file.get(), &facts) != 0) return refused(reasonOf(errno));
    if (const std::string_view other = otherThanFile(facts.st_mode); !other.empty()) return refused(other);  // exchanged meanwhile
    struct statfs system = {};
    if (::fstatfs(file.get(), &system) == 0 && isVirtual(static_cast<long>(system.f_type)))
        return refused("it is on a virtual file system such as /proc or /sys; name a regular file");
    return file;
}

Status checkInput(const std::string& path) {
    const Result<Descriptor> file = openInput(path);
    return file ? ok() : Status(file.error());
}

}  // namespace rivulet
