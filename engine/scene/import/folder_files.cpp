#include "engine/scene/import/folder_files.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <assimp/IOStream.hpp>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <system_error>

#include "engine/scene/import/sandbox.h"

namespace rivulet {
namespace {

namespace fs = std::filesystem;

class FileStream final : public Assimp::IOStream {
  public:
    FileStream(std::FILE* file, size_t bytes) : file_(file, std::fclose), bytes_(bytes) {}
    size_t Read(void* to, size_t size, size_t count) override { return size == 0 ? 0 : std::fread(to, size, count, file_.get()); }
    size_t Write(const void*, size_t, size_t) override { return 0; }
    aiReturn Seek(size_t offset, aiOrigin origin) override {
        const int from = origin == aiOrigin_SET ? SEEK_SET : origin == aiOrigin_CUR ? SEEK_CUR : SEEK_END;
        return std::fseek(file_.get(), static_cast<long>(offset), from) == 0 ? aiReturn_SUCCESS : aiReturn_FAILURE;
    }
    size_t Tell() const override { return static_cast<size_t>(std::ftell(file_.get())); }
    size_t FileSize() const override { return bytes_; }
    void Flush() override {}

  private:
    std::unique_ptr<std::FILE, int (*)(std::FILE*)> file_;
    size_t bytes_;
};

// The path without links and `..`; empty if there is no such file.
std::string realPath(const std::string& path) {
    std::error_code error;
    return fs::canonical(path, error).string();
}

bool isPlainFile(const std::string& path, size_t& bytes) {
    struct stat status {};
    if (::lstat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return false;
    bytes = static_cast<size_t>(status.st_size);
    return true;
}

}  // namespace

FolderFiles::FolderFiles(const std::string& model)
    : model_(realPath(model)), folder_(realPath(fs::absolute(model).parent_path().string())) {
    if (!folder_.ends_with('/')) folder_ += '/';
}

Result<std::string> FolderFiles::resolve(const std::string& path) const {
    std::string real = realPath(path);
    if (real.empty()) return badInput(fmt::format("names the file '{}', and there is no such file; copy it beside the mesh", path));
    size_t bytes = 0;
    if (real != model_ && !real.starts_with(folder_))
        return badInput(fmt::format("names the file '{}', which is outside its folder; copy that file beside the mesh", path));
    if (!isPlainFile(real, bytes)) return badInput(fmt::format("names '{}', which is not a plain file", path));
    return real;
}

bool FolderFiles::Exists(const char* path) const { return bool{resolve(path)}; }

Assimp::IOStream* FolderFiles::Open(const char* path, const char* mode) {
    if (mode == nullptr || mode[0] != 'r') return nullptr;
    const Result<std::string> real = resolve(path);
    if (!real) {
        if (refusal_.empty() && !realPath(path).empty()) refusal_ = real.error().message;
        return nullptr;
    }
    std::FILE* file = std::fopen(real->c_str(), "rb");
    size_t bytes = 0;
    if (file == nullptr || !isPlainFile(*real, bytes)) {
        if (file != nullptr) (void)std::fclose(file);
        return nullptr;
    }
    if (opened_.insert(*real).second) allowFor(bytes);
    return new FileStream(file, bytes);  // Close deletes it
}

void FolderFiles::Close(Assimp::IOStream* file) { delete file; }

}  // namespace rivulet
