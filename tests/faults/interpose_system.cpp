// Memory, files, processes and threads.
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <spawn.h>
#include <stdarg.h>
#include <stdio.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <new>

#include "tests/faults/interposer.h"

using namespace faults;

namespace {

// Sets errno. For calls that return -1, an error number or null: see their callers.
template <class T>
T refuse(int error, T result) {
    errno = error;
    return result;
}

bool writes(int flags) { return (flags & O_ACCMODE) != O_RDONLY || (flags & O_CREAT) != 0; }
bool failsToOpen(int flags, const void* caller) { return fails(writes(flags) ? kOpen : kOpenRead, caller); }
int errorOfOpen(int flags) { return writes(flags) ? ENOSPC : EMFILE; }

mode_t modeOf(int flags, va_list more) { return (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(more, mode_t) : 0; }

}  // namespace

extern "C" {

// glibc's own names: dlsym() needs memory, too.
void* __libc_malloc(size_t);
void* __libc_calloc(size_t, size_t);
void* __libc_realloc(void*, size_t);
void* __libc_memalign(size_t, size_t);

void* malloc(size_t bytes) { return fails(kMemory, FAULTS_CALLER) ? refuse<void*>(ENOMEM, nullptr) : __libc_malloc(bytes); }
void* calloc(size_t count, size_t bytes) {
    return fails(kMemory, FAULTS_CALLER) ? refuse<void*>(ENOMEM, nullptr) : __libc_calloc(count, bytes);
}
void* realloc(void* old, size_t bytes) {
    return fails(kMemory, FAULTS_CALLER) ? refuse<void*>(ENOMEM, nullptr) : __libc_realloc(old, bytes);
}
void* memalign(size_t alignment, size_t bytes) {
    return fails(kMemory, FAULTS_CALLER) ? refuse<void*>(ENOMEM, nullptr) : __libc_memalign(alignment, bytes);
}
void* aligned_alloc(size_t alignment, size_t bytes) {
    return fails(kMemory, FAULTS_CALLER) ? refuse<void*>(ENOMEM, nullptr) : __libc_memalign(alignment, bytes);
}
int posix_memalign(void** to, size_t alignment, size_t bytes) {
    if (fails(kMemory, FAULTS_CALLER)) return ENOMEM;
    *to = __libc_memalign(alignment, bytes);
    return *to != nullptr ? 0 : ENOMEM;
}

void* mmap(void* at, size_t bytes, int protection, int flags, int file, off_t offset) {
    if (fails(kMap, FAULTS_CALLER)) return refuse(ENOMEM, MAP_FAILED);
    return FAULTS_NEXT(mmap)(at, bytes, protection, flags, file, offset);
}

#define FAULTS_OPEN(name)                                                             \
    int name(const char* path, int flags, ...) {                                      \
        va_list more;                                                                 \
        va_start(more, flags);                                                        \
        const mode_t mode = modeOf(flags, more);                                      \
        va_end(more);                                                                 \
        if (failsToOpen(flags, FAULTS_CALLER)) return refuse(errorOfOpen(flags), -1); \
        return FAULTS_NEXT(name)(path, flags, mode);                                  \
    }
#define FAULTS_OPENAT(name)                                                           \
    int name(int folder, const char* path, int flags, ...) {                          \
        va_list more;                                                                 \
        va_start(more, flags);                                                        \
        const mode_t mode = modeOf(flags, more);                                      \
        va_end(more);                                                                 \
        if (failsToOpen(flags, FAULTS_CALLER)) return refuse(errorOfOpen(flags), -1); \
        return FAULTS_NEXT(name)(folder, path, flags, mode);                          \
    }
FAULTS_OPEN(open)
FAULTS_OPEN(open64)
FAULTS_OPENAT(openat)
FAULTS_OPENAT(openat64)
#define FAULTS_FOPEN(name)                                                                        \
    FILE* name(const char* path, const char* mode) {                                              \
        const int flags = mode[0] == 'r' && mode[1] != '+' ? O_RDONLY : O_WRONLY;                 \
        if (failsToOpen(flags, FAULTS_CALLER)) return refuse<FILE*>(errorOfOpen(flags), nullptr); \
        return FAULTS_NEXT(name)(path, mode);                                                     \
    }
FAULTS_FOPEN(fopen)
FAULTS_FOPEN(fopen64)

int pipe2(int* ends, int flags) { return fails(kOpenRead, FAULTS_CALLER) ? refuse(EMFILE, -1) : FAULTS_NEXT(pipe2)(ends, flags); }
int socketpair(int domain, int type, int protocol, int* ends) {
    return fails(kOpenRead, FAULTS_CALLER) ? refuse(EMFILE, -1) : FAULTS_NEXT(socketpair)(domain, type, protocol, ends);
}
int memfd_create(const char* name, unsigned flags) {
    return fails(kOpenRead, FAULTS_CALLER) ? refuse(EMFILE, -1) : FAULTS_NEXT(memfd_create)(name, flags);
}

ssize_t read(int file, void* to, size_t bytes) {
    return fails(kRead, FAULTS_CALLER) ? refuse<ssize_t>(EIO, -1) : FAULTS_NEXT(read)(file, to, bytes);
}
ssize_t pread(int file, void* to, size_t bytes, off_t offset) {
    return fails(kRead, FAULTS_CALLER) ? refuse<ssize_t>(EIO, -1) : FAULTS_NEXT(pread)(file, to, bytes, offset);
}
// The terminal is no file: messages must arrive.
ssize_t write(int file, const void* from, size_t bytes) {
    if (file <= STDERR_FILENO || !fails(kWrite, FAULTS_CALLER)) return FAULTS_NEXT(write)(file, from, bytes);
    if (bytes > 1) (void)FAULTS_NEXT(write)(file, from, bytes / 2);  // a full disk takes what it can
    return refuse<ssize_t>(ENOSPC, -1);
}
ssize_t pwrite(int file, const void* from, size_t bytes, off_t offset) {
    return fails(kWrite, FAULTS_CALLER) ? refuse<ssize_t>(ENOSPC, -1) : FAULTS_NEXT(pwrite)(file, from, bytes, offset);
}
ssize_t send(int file, const void* from, size_t bytes, int flags) {
    return fails(kSend, FAULTS_CALLER) ? refuse<ssize_t>(EPIPE, -1) : FAULTS_NEXT(send)(file, from, bytes, flags);
}
int fsync(int file) { return fails(kSync, FAULTS_CALLER) ? refuse(EIO, -1) : FAULTS_NEXT(fsync)(file); }
int fdatasync(int file) { return fails(kSync, FAULTS_CALLER) ? refuse(EIO, -1) : FAULTS_NEXT(fdatasync)(file); }
int rename(const char* from, const char* to) { return fails(kRename, FAULTS_CALLER) ? refuse(EIO, -1) : FAULTS_NEXT(rename)(from, to); }
int link(const char* from, const char* to) { return fails(kLink, FAULTS_CALLER) ? refuse(EPERM, -1) : FAULTS_NEXT(link)(from, to); }
int close(int file) {
    if (!fails(kClose, FAULTS_CALLER)) return FAULTS_NEXT(close)(file);
    (void)FAULTS_NEXT(close)(file);
    return refuse(EIO, -1);
}
int mkdir(const char* path, mode_t mode) { return fails(kFolder, FAULTS_CALLER) ? refuse(ENOSPC, -1) : FAULTS_NEXT(mkdir)(path, mode); }

int posix_spawn(pid_t* pid, const char* path, const posix_spawn_file_actions_t* files, const posix_spawnattr_t* attributes,
                char* const* words, char* const* environment) {
    if (fails(kProcess, FAULTS_CALLER)) return EAGAIN;
    return FAULTS_NEXT(posix_spawn)(pid, path, files, attributes, words, environment);
}
int posix_spawnp(pid_t* pid, const char* name, const posix_spawn_file_actions_t* files, const posix_spawnattr_t* attributes,
                 char* const* words, char* const* environment) {
    if (fails(kProcess, FAULTS_CALLER)) return EAGAIN;
    return FAULTS_NEXT(posix_spawnp)(pid, name, files, attributes, words, environment);
}
pid_t fork() { return fails(kProcess, FAULTS_CALLER) ? refuse<pid_t>(EAGAIN, -1) : FAULTS_NEXT(fork)(); }
int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*work)(void*), void* with) {
    return fails(kThread, FAULTS_CALLER) ? EAGAIN : FAULTS_NEXT(pthread_create)(thread, attributes, work, with);
}

}  // extern "C"

// As the C++ runtime's, whose caller is known without unwinding.
namespace {

void* allocate(size_t bytes, size_t alignment, const void* caller) noexcept {
    if (fails(kMemory, caller)) return nullptr;
    if (bytes == 0) bytes = 1;
    return alignment > 0 ? __libc_memalign(alignment, bytes) : __libc_malloc(bytes);
}
void* orThrow(void* at) {
    if (at == nullptr) throw std::bad_alloc();
    return at;
}

}  // namespace

void* operator new(size_t bytes) { return orThrow(allocate(bytes, 0, FAULTS_CALLER)); }
void* operator new[](size_t bytes) { return orThrow(allocate(bytes, 0, FAULTS_CALLER)); }
void* operator new(size_t bytes, const std::nothrow_t&) noexcept { return allocate(bytes, 0, FAULTS_CALLER); }
void* operator new[](size_t bytes, const std::nothrow_t&) noexcept { return allocate(bytes, 0, FAULTS_CALLER); }
void* operator new(size_t bytes, std::align_val_t to) { return orThrow(allocate(bytes, static_cast<size_t>(to), FAULTS_CALLER)); }
void* operator new[](size_t bytes, std::align_val_t to) { return orThrow(allocate(bytes, static_cast<size_t>(to), FAULTS_CALLER)); }
void* operator new(size_t bytes, std::align_val_t to, const std::nothrow_t&) noexcept {
    return allocate(bytes, static_cast<size_t>(to), FAULTS_CALLER);
}
void* operator new[](size_t bytes, std::align_val_t to, const std::nothrow_t&) noexcept {
    return allocate(bytes, static_cast<size_t>(to), FAULTS_CALLER);
}
void operator delete(void* at) noexcept { std::free(at); }
void operator delete[](void* at) noexcept { std::free(at); }
void operator delete(void* at, size_t) noexcept { std::free(at); }
void operator delete[](void* at, size_t) noexcept { std::free(at); }
void operator delete(void* at, std::align_val_t) noexcept { std::free(at); }
void operator delete[](void* at, std::align_val_t) noexcept { std::free(at); }
void operator delete(void* at, size_t, std::align_val_t) noexcept { std::free(at); }
void operator delete[](void* at, size_t, std::align_val_t) noexcept { std::free(at); }
