// The calls on files that differ between POSIX and Windows. Paths are UTF-8. Where a function returns an int, it is 0 or an errno.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "engine/core/descriptor.h"

namespace rivulet {

struct FileFacts {
    enum class Kind { none, regular, folder, pipe, socket, device } kind = Kind::none;
    int error = 0;           // of none: why
    uint64_t bytes = 0;      // of a regular file
    unsigned mode = 0;       // permissions, as chmod(2)
    bool isVirtual = false;  // an open file of a file system that the kernel makes up (/proc, /sys)
    // Which file it is (on Windows 0, 0: an open file cannot be replaced there), and when its bytes last changed, in the system's own unit.
    uint64_t device = 0, number = 0, changed = 0;
    bool operator==(const FileFacts&) const = default;
};
FileFacts factsOf(const std::string& path);  // links are followed
FileFacts factsOf(const Descriptor& file);

std::optional<std::string> followed(const std::string& path);  // with its links followed; nothing: errno says why
int mayWrite(const std::string& path);                         // the file exists
// Renames; a file that has the name is replaced at once.
int replaceFile(const std::string& from, const std::string& to);
// Renames if no file has the name.
int nameFile(const std::string& from, const std::string& to);
void removeFile(const char* path) noexcept;  // safe in a handler of signals
int setMode(const Descriptor& file, unsigned mode);
int syncToDisk(const Descriptor& file);
void syncFolderOf(const std::string& path);  // some file systems cannot: the file is complete all the same
Descriptor duplicateOf(int descriptor);      // not valid: errno says why
// Writes at the file's place; the number of bytes, -1: errno says why.
std::ptrdiff_t writeSome(const Descriptor& file, const void* from, size_t bytes);
// Reads at a place; where the file itself stands is then undefined. Returns the number of bytes, 0 at the end, -1: errno says why.
std::ptrdiff_t readAt(const Descriptor& file, void* to, size_t bytes, uint64_t at);

using ProcessId = int;
ProcessId processId() noexcept;  // safe in a handler of signals

}  // namespace rivulet
