// POSIX files. A read is bounded; a write is complete or changes nothing.
#include "engine/core/file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <system_error>

namespace rivulet {

namespace {

namespace fs = std::filesystem;

class Descriptor {
  public:
    explicit Descriptor(int fd) : fd_(fd) {}
    ~Descriptor() { close(); }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    bool valid() const { return fd_ >= 0; }
    int get() const { return fd_; }
    bool close() {  // false: what was written may be lost
        const bool closed = fd_ < 0 || ::close(fd_) == 0;
        fd_ = -1;
        return closed;
    }

  private:
    int fd_;
};

std::string reason(int error) {
    switch (error) {
        case ENOENT:
            return "it does not exist";
        case EACCES:
        case EPERM:
            return "permission is denied";
        case EISDIR:
            return "it is a folder";
        case ENOTDIR:
            return "a part of its path is not a folder";
        case ENOSPC:
        case EDQUOT:
            return "the disk is full";
        case EROFS:
            return "the file system is read-only";
        case ENAMETOOLONG:
            return "its name is too long";
        default:
            return std::generic_category().message(error);
    }
}

Error cannotRead(const std::string& path, const std::string& why) { return badInput(fmt::format("{} cannot be read: {}", path, why)); }
Error cannotWrite(const std::string& path, const std::string& why) { return failed(fmt::format("{} cannot be written: {}", path, why)); }

// 0, or errno.
int writeAll(int fd, std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t written = ::write(fd, bytes.data(), bytes.size());
        if (written < 0 && errno != EINTR) return errno;
        if (written > 0) bytes.remove_prefix(static_cast<size_t>(written));
    }
    return 0;
}

Status writeInto(const std::string& path, std::string_view bytes) {
    Descriptor file(::open(path.c_str(), O_WRONLY | O_CLOEXEC));
    if (!file.valid()) return cannotWrite(path, reason(errno));
    if (const int error = writeAll(file.get(), bytes)) return cannotWrite(path, reason(error));
    return ok();
}

// A new file beside `target`; its name goes to `name`.
int openBeside(const std::string& target, std::string& name, unsigned mode) {
    for (int attempt = 0;; ++attempt) {
        name = fmt::format("{}.{}-{}.tmp", target, ::getpid(), attempt);
        const int fd = ::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
        if (fd >= 0 || errno != EEXIST) return fd;
    }
}

}  // namespace

Result<std::string> readFile(const std::string& path, size_t maxBytes) {
    Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
    if (!file.valid()) return cannotRead(path, reason(errno));
    struct stat status {};
    if (::fstat(file.get(), &status) != 0) return cannotRead(path, reason(errno));
    if (S_ISDIR(status.st_mode)) return cannotRead(path, "it is a folder");
    const std::string tooLarge = fmt::format("it is larger than {} MiB", maxBytes >> 20U);
    if (status.st_size > 0 && static_cast<size_t>(status.st_size) > maxBytes) return cannotRead(path, tooLarge);

    std::string text;  // a pipe or a device says no size: read until it ends or is too large
    size_t filled = 0;
    for (;;) {
        if (filled == text.size()) text.resize(std::max({filled * 2, static_cast<size_t>(status.st_size) + 1, size_t{4096}}));
        const ssize_t got = ::read(file.get(), text.data() + filled, text.size() - filled);
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) return cannotRead(path, reason(errno));
        if (got == 0) break;
        filled += static_cast<size_t>(got);
        if (filled > maxBytes) return cannotRead(path, tooLarge);
    }
    text.resize(filled);
    return text;
}

// Against a full disk and a crash of the program, not of the machine: nothing waits for the disk (fsync).
Status writeFileAtomic(const std::string& path, std::string_view bytes, unsigned mode) {
    std::error_code error;
    const fs::file_status existing = fs::status(path, error);
    if (fs::is_directory(existing)) return cannotWrite(path, "it is a folder");
    if (fs::exists(existing) && !fs::is_regular_file(existing)) return writeInto(path, bytes);  // /dev/stdout must stay a device
    std::string target = path;
    if (fs::exists(existing)) {
        target = fs::canonical(path, error).string();  // a link stays a link
        if (error || ::access(target.c_str(), W_OK) != 0) return cannotWrite(path, "permission is denied");
    }

    std::string temporary;
    Descriptor file(openBeside(target, temporary, mode));
    if (!file.valid()) {
        const int why = errno;
        const fs::path folder = fs::path(target).parent_path();
        const bool gone = why == ENOENT && !folder.empty() && !fs::exists(folder, error);
        return cannotWrite(path, gone ? "its folder does not exist" : why == ENOENT ? "no file can be made in its folder" : reason(why));
    }
    if (fs::exists(existing)) (void)::fchmod(file.get(), static_cast<mode_t>(existing.permissions()));
    int failure = writeAll(file.get(), bytes);
    if (!file.close() && failure == 0) failure = errno;
    if (failure == 0 && ::rename(temporary.c_str(), target.c_str()) != 0) failure = errno;
    if (failure == 0) return ok();
    (void)::unlink(temporary.c_str());
    return cannotWrite(path, reason(failure));
}

}  // namespace rivulet
