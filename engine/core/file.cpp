#include "engine/core/file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>

#include "engine/core/file_system.h"
#include "engine/core/input_file.h"

namespace rivulet {

Result<std::string> readFile(const std::string& path, size_t maxBytes) {
    const Result<Descriptor> file = openInput(path);
    if (!file) return file.error();
    const auto refused = [&](const std::string& why) { return badInput(fmt::format("{} cannot be read: {}", path, why)); };
    const FileFacts facts = factsOf(*file);
    if (facts.error != 0) return refused(reasonOf(facts.error));
    const std::string tooLarge = fmt::format("it is larger than {} MiB", maxBytes >> 20U);
    if (facts.bytes > maxBytes) return refused(tooLarge);

    std::string text;  // the file may grow meanwhile: read until it ends or is too large
    size_t filled = 0;
    for (;;) {
        if (filled == text.size()) text.resize(std::max({filled * 2, static_cast<size_t>(facts.bytes) + 1, size_t{4096}}));
        const std::ptrdiff_t got = readAt(*file, text.data() + filled, text.size() - filled, filled);
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
    if (factsOf(path).kind == FileFacts::Kind::pipe) {
        // Opening a pipe waits for its reader, and closing it would end that reader's input: only the permission is tested.
        const int error = mayWrite(path);
        return error == 0 ? ok() : Status(failed(fmt::format("{} cannot be written: {}", path, reasonOf(error))));
    }
    const Result<NewFile> file = NewFile::open(path);
    return file ? ok() : Status(file.error());
}

}  // namespace rivulet
