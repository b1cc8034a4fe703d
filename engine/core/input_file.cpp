#include "engine/core/input_file.h"

#include <fcntl.h>
#include <fmt/format.h>

#include <cerrno>
#include <string_view>

#include "engine/core/file_system.h"

namespace rivulet {

namespace {

// "": a regular file.
std::string_view otherThanFile(FileFacts::Kind kind) {
    using enum FileFacts::Kind;
    switch (kind) {
        case regular:
            return "";
        case folder:
            return "it is a folder";
        case pipe:
            return "it is a pipe; write its data to a file first";
        case socket:
            return "it is a socket; name a file";
        default:
            return "it is a device; name a file";
    }
}

}  // namespace

Result<Descriptor> openInput(const std::string& path) {
    const auto refused = [&](std::string_view why) { return badInput(fmt::format("{} cannot be read: {}", path, why)); };
    const FileFacts before = factsOf(path);
    if (before.error != 0) return refused(reasonOf(before.error));
    if (const std::string_view other = otherThanFile(before.kind); !other.empty()) return refused(other);  // opening it may have effects
    Descriptor file = openDescriptor(path, O_RDONLY | kNeverWaits);
    if (!file.valid()) return refused(reasonOf(errno));
    const FileFacts facts = factsOf(file);
    if (facts.error != 0) return refused(reasonOf(facts.error));
    if (const std::string_view other = otherThanFile(facts.kind); !other.empty()) return refused(other);  // exchanged meanwhile
    if (facts.isVirtual) return refused("it is on a virtual file system such as /proc or /sys; name a regular file");
    return file;
}

Status checkInput(const std::string& path) {
    const Result<Descriptor> file = openInput(path);
    return file ? ok() : Status(file.error());
}

}  // namespace rivulet
