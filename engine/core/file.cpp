#include "engine/core/file.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

#include "engine/core/input_file.h"

namespace rivulet {

Result<std::string> readFile(const std::string& path, size_t maxBytes) {
    const Result<Descriptor> file = openInput(path);
    if (!file) return file.error();
    const auto refused = [&](const std::string& why) { return badInput(fmt::format("{} cannot be read: {}", path, why)); };
    struct stat status = {};
    if (::fstat(file->get(), &status) != 0) return refused(reasonOf(errno));
    const std::string tooLarge = fmt::format("it is larger than {} MiB", maxBytes >> 20U);
    if (status.st_size > 0 && static_cast<size_t>(status.st_size) > maxBytes) return refused(tooLarge);

    std::string text;  // the file may grow meanwhile: read until it ends or is too large
    size_t filled = 0;
    for (;;) {
        if (filled == text.size()) text.resize(std::max({filled * 2, static_cast<size_t>(status.st_size) + 1, size_t{4096}}));
        const ssize_t got = ::read(file->get(), text.data() + filled, text.size() - filled);
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) return refused(reasonOf(errno));
        if (got == 0) break;
        filled += static_cast<size_t>(got);
        if (filled > maxBytes) return refused(tooLarge);
    }
    text.resize(filled);
    return text;
}

Status writeFileAtomic(const std::string& path, std::string_view bytes, unsigned mode, Sync sync) {
    Result<NewFile> file = NewFile::open(path, mode);
    if (!file) return file.error();
    if (Status written = file->write(bytes); !written) return written;
    return file->commit(sync);
}

Status checkWritable(const std::string& path) {
    struct stat facts = {};
    if (::stat(path.c_str(), &facts) == 0 && S_ISFIFO(facts.st_mode)) {
        // Opening a pipe waits for its reader, and closing it would end that reader's input: only the permission is tested.
        if (::access(path.c_str(), W_OK) == 0) return ok();
        return failed(fmt::format("{} cannot be written: {}", path, reasonOf(errno)));
    }
    const Result<NewFile> file = NewFile::open(path);
    return file ? ok() : Status(file.error());
}

}  // namespace rivulet
