#include "engine/core/descriptor.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

namespace rivulet {

int Descriptor::close() { return fd_ < 0 || ::close(std::exchange(fd_, -1)) == 0 ? 0 : errno; }

Descriptor openDescriptor(const std::string& path, int flags, unsigned mode) {
    Descriptor file(::open(path.c_str(), flags | O_CLOEXEC, mode));
    constexpr int kFirst = STDERR_FILENO + 1;
    if (file.valid() && file.get() < kFirst) {
        Descriptor above(::fcntl(file.get(), F_DUPFD_CLOEXEC, kFirst));
        const int error = errno;
        (void)file.close();
        errno = error;
        return above;
    }
    return file;
}

std::string reasonOf(int error) {
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
        case EFBIG:
            return "it exceeds the size that the system allows (ulimit -f)";
        case EROFS:
            return "the file system is read-only";
        case ENAMETOOLONG:
            return "its name is too long";
        case EMFILE:
        case ENFILE:
            return "too many files are open (ulimit -n)";
        case EPIPE:
            return "nothing reads from the pipe";
        default:
            return std::generic_category().message(error);
    }
}

}  // namespace rivulet
