// Windows: paths are UTF-16, and a file that is open elsewhere can be neither replaced nor removed.
#include <fcntl.h>
#include <io.h>
#include <process.h>
#include <sys/stat.h>
#include <windows.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <filesystem>

#include "engine/core/file_system.h"

namespace rivulet {

namespace {

namespace fs = std::filesystem;

HANDLE handleOf(const Descriptor& file) { return reinterpret_cast<HANDLE>(::_get_osfhandle(file.get())); }

int errnoOf(DWORD error) {
    switch (error) {
        case ERROR_SUCCESS:
            return 0;
        case ERROR_FILE_NOT_FOUND:
        case ERROR_PATH_NOT_FOUND:
        case ERROR_INVALID_NAME:
            return ENOENT;
        case ERROR_ACCESS_DENIED:
        case ERROR_SHARING_VIOLATION:
        case ERROR_LOCK_VIOLATION:
            return EACCES;
        case ERROR_ALREADY_EXISTS:
        case ERROR_FILE_EXISTS:
            return EEXIST;
        case ERROR_DISK_FULL:
        case ERROR_HANDLE_DISK_FULL:
            return ENOSPC;
        case ERROR_WRITE_PROTECT:
            return EROFS;
        case ERROR_BROKEN_PIPE:
        case ERROR_NO_DATA:
            return EPIPE;
        default:
            return EIO;
    }
}

uint64_t numberOf(const FILETIME& time) { return uint64_t{time.dwHighDateTime} << 32U | time.dwLowDateTime; }

int lastError(bool done) { return done ? 0 : errnoOf(::GetLastError()); }

// CON, NUL and the like are devices in every folder; GetFileAttributes says so of none of them.
bool isDeviceName(const std::string& path) {
    std::string name = fs::path(path).stem().string();
    std::transform(name.begin(), name.end(), name.begin(), [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 32) : c; });
    constexpr std::array<const char*, 6> kDevices = {"CON", "PRN", "AUX", "NUL", "CONIN$", "CONOUT$"};
    if (std::find(kDevices.begin(), kDevices.end(), name) != kDevices.end()) return true;
    return name.size() == 4 && (name.starts_with("COM") || name.starts_with("LPT")) && name[3] >= '0' && name[3] <= '9';
}

}  // namespace

FileFacts factsOf(const std::string& path) {
    if (isDeviceName(path)) return {.kind = FileFacts::Kind::device};
    WIN32_FILE_ATTRIBUTE_DATA data = {};
    if (!::GetFileAttributesExW(fs::path(path).c_str(), GetFileExInfoStandard, &data)) return {.error = errnoOf(::GetLastError())};
    const bool folder = (data.dwFileAttributes & FILE_ATTRIBUTE_DIRECTORY) != 0;
    const bool locked = (data.dwFileAttributes & FILE_ATTRIBUTE_READONLY) != 0;
    return {.kind = folder ? FileFacts::Kind::folder : FileFacts::Kind::regular,
            .bytes = uint64_t{data.nFileSizeHigh} << 32U | data.nFileSizeLow,
            .mode = locked ? unsigned{_S_IREAD} : unsigned{_S_IREAD | _S_IWRITE},
            .changed = numberOf(data.ftLastWriteTime)};
}

FileFacts factsOf(const Descriptor& file) {
    const DWORD type = ::GetFileType(handleOf(file));
    if (type == FILE_TYPE_PIPE) return {.kind = FileFacts::Kind::pipe};
    if (type != FILE_TYPE_DISK) return {.kind = FileFacts::Kind::device};
    LARGE_INTEGER bytes = {};
    if (!::GetFileSizeEx(handleOf(file), &bytes)) return {.error = errnoOf(::GetLastError())};
    FILETIME written = {};
    (void)::GetFileTime(handleOf(file), nullptr, nullptr, &written);
    return {.kind = FileFacts::Kind::regular, .bytes = static_cast<uint64_t>(bytes.QuadPart), .changed = numberOf(written)};
}

std::optional<std::string> followed(const std::string& path) {
    std::error_code error;
    const fs::path whole = fs::canonical(path, error);
    if (!error) return whole.string();
    errno = error.default_error_condition().value();
    return std::nullopt;
}

int mayWrite(const std::string& path) { return ::_waccess(fs::path(path).c_str(), 2) == 0 ? 0 : errno; }

int replaceFile(const std::string& from, const std::string& to) {
    return lastError(::MoveFileExW(fs::path(from).c_str(), fs::path(to).c_str(), MOVEFILE_REPLACE_EXISTING | MOVEFILE_WRITE_THROUGH) != 0);
}

// An open file keeps its name: this fails before the writer has closed it.
int nameFile(const std::string& from, const std::string& to) {
    return lastError(::MoveFileExW(fs::path(from).c_str(), fs::path(to).c_str(), 0) != 0);
}

void removeFile(const char* path) noexcept {
    std::array<wchar_t, 1024> wide = {};
    if (::MultiByteToWideChar(CP_UTF8, 0, path, -1, wide.data(), static_cast<int>(wide.size())) > 0) (void)::DeleteFileW(wide.data());
}

int setMode(const Descriptor&, unsigned) { return 0; }  // permissions are those of the folder

int syncToDisk(const Descriptor& file) {
    if (::GetFileType(handleOf(file)) != FILE_TYPE_DISK) return EINVAL;
    return lastError(::FlushFileBuffers(handleOf(file)) != 0);
}

void syncFolderOf(const std::string&) {}  // MOVEFILE_WRITE_THROUGH has done it

Descriptor duplicateOf(int descriptor) {
    Descriptor low[3];  // what is not to be 0, 1 or 2
    for (Descriptor& copy : low) {
        copy = Descriptor(::_dup(descriptor));
        if (!copy.valid() || copy.get() > 2) return std::move(copy);
    }
    return Descriptor(::_dup(descriptor));
}

std::ptrdiff_t writeSome(const Descriptor& file, const void* from, size_t bytes) {
    constexpr size_t kMost = size_t{1} << 30U;
    return ::_write(file.get(), from, static_cast<unsigned>(std::min(bytes, kMost)));
}

std::ptrdiff_t readAt(const Descriptor& file, void* to, size_t bytes, uint64_t at) {
    constexpr size_t kMost = size_t{1} << 30U;
    OVERLAPPED place = {};
    place.Offset = static_cast<DWORD>(at);
    place.OffsetHigh = static_cast<DWORD>(at >> 32U);
    DWORD got = 0;
    if (::ReadFile(handleOf(file), to, static_cast<DWORD>(std::min(bytes, kMost)), &got, &place)) return got;
    if (::GetLastError() == ERROR_HANDLE_EOF) return 0;
    errno = errnoOf(::GetLastError());
    return -1;
}

ProcessId processId() noexcept { return ::_getpid(); }

}  // namespace rivulet
