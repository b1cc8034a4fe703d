// Private files of a user on POSIX: owner and permissions.
#include "engine/core/private_file.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <system_error>

#include "engine/core/file.h"

namespace rivulet {

namespace {

namespace fs = std::filesystem;

constexpr mode_t kOthersWrite = S_IWGRP | S_IWOTH, kOthers = S_IRWXG | S_IRWXO;

bool isOurs(const struct stat& status) { return status.st_uid == ::geteuid(); }

// A folder of ours that its group may write to, as an umask of 002 makes it, is closed to the group. What is in it is checked file by file.
void closeToGroup(const std::string& folder, struct stat& status) {
    if (!isOurs(status) || (status.st_mode & kOthersWrite) != S_IWGRP) return;
    const mode_t closed = status.st_mode & 07777U & ~mode_t{S_IWGRP};
    if (::chmod(folder.c_str(), closed) == 0) status.st_mode &= ~mode_t{S_IWGRP};
}

Error notPrivate(const std::string& folder, const char* why) {
    return failed(fmt::format("the folder {} {}; delete it, or set XDG_CACHE_HOME to a folder that only you may write to", folder, why));
}

}  // namespace

Status checkPrivateFolder(const std::string& folder) {
    struct stat own {};
    if (::stat(folder.c_str(), &own) != 0 || !S_ISDIR(own.st_mode)) return ok();  // nothing is read there
    closeToGroup(folder, own);
    if (!isOurs(own)) return notPrivate(folder, "belongs to another user");
    if ((own.st_mode & kOthersWrite) != 0) return notPrivate(folder, "may be written to by other users");
    const std::string above = fs::path(folder).lexically_normal().parent_path().string();
    struct stat outer {};
    if (!above.empty() && ::stat(above.c_str(), &outer) == 0) {
        closeToGroup(above, outer);
        if (!isOurs(outer) && outer.st_uid != 0) return notPrivate(above, "belongs to another user");
        if ((outer.st_mode & kOthersWrite) != 0 && (outer.st_mode & S_ISVTX) == 0)
            return notPrivate(above, "may be written to by other users");
    }
    if ((own.st_mode & kOthers) != 0) (void)::chmod(folder.c_str(), S_IRWXU);
    return ok();
}

Status makePrivateFolder(const std::string& folder) {
    fs::path made;
    for (const fs::path& name : fs::path(folder)) {
        made /= name;
        if (::mkdir(made.c_str(), S_IRWXU) == 0 || errno == EEXIST) continue;
        const int why = errno;
        if (::access(made.c_str(), F_OK) != 0)
            return failed(fmt::format("the folder {} cannot be made: {}", made.string(), std::generic_category().message(why)));
    }
    return checkPrivateFolder(folder);
}

Status checkPrivateFile(const std::string& path) {
    struct stat status {};
    if (::lstat(path.c_str(), &status) != 0) return ok();
    if (!S_ISREG(status.st_mode)) return failed(fmt::format("{} is not a plain file", path));
    if (!isOurs(status)) return failed(fmt::format("{} belongs to another user", path));
    if ((status.st_mode & kOthersWrite) != 0) return failed(fmt::format("{} may be written to by other users", path));
    return ok();
}

Status writePrivateFile(const std::string& path, std::string_view bytes) {
    if (!checkPrivateFile(path)) (void)::unlink(path.c_str());  // a folder stays, and is an error below
    return writeFileAtomic(path, bytes, S_IRUSR | S_IWUSR, Sync::none);
}

}  // namespace rivulet
