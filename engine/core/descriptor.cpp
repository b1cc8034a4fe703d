#include "engine/core/descriptor.h"

#include <fcntl.h>

#include <cerrno>
#include <system_error>

#if defined(_WIN32)
#include <io.h>

#include <filesystem>
#else
#include <unistd.h>
#endif

#include "engine/core/file_system.h"

namespace rivulet {

namespace {

#if defined(_WIN32)
int openFile(const std::string& path, int flags, unsigned mode) {
    return ::_wopen(std::filesystem::path(path).c_str(), flags | _O_BINARY | _O_NOINHERIT, static_cast<int>(mode));
}
#else
int openFile(const std::string& path, int flags, unsigned mode) { return ::open(path.c_str(), flags | O_CLOEXEC | O_NOCTTY, mode); }
#endif

}  // namespace

#if defined(_WIN32)
const int kNeverWaits = 0;  // a pipe has no name in a folder
#else
const int kNeverWaits = O_NONBLOCK;
#endif

int Descriptor::close() { return fd_ < 0 || ::close(std::exchange(fd_, -1)) == 0 ? 0 : errno; }

Descriptor openDescriptor(const std::string& path, int flags, unsigned mode) {
    Descriptor file(openFile(path, flags, mode));
    constexpr int kFirst = 3;
    if (file.valid() && file.get() < kFirst) {
        Descriptor above = duplicateOf(file.get());
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
#if defined(EDQUOT)
        case EDQUOT:
#endif
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
