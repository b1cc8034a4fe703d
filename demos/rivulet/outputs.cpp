#include "demos/rivulet/outputs.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <utility>

#include "engine/core/new_file.h"

namespace rivulet {

namespace {

namespace fs = std::filesystem;

std::optional<struct stat> factsOf(const std::string& path) {
    struct stat facts = {};
    return ::stat(path.c_str(), &facts) == 0 ? std::optional(facts) : std::nullopt;
}

bool same(const struct stat& a, const struct stat& b) { return a.st_dev == b.st_dev && a.st_ino == b.st_ino; }

// Its links followed as far as it exists.
fs::path wholePath(const fs::path& path) {
    std::error_code error;
    const fs::path whole = fs::absolute(path, error), canonical = fs::weakly_canonical(whole, error);
    return error ? whole.lexically_normal() : canonical;
}

bool sameFile(const std::string& a, const std::string& b) {
    const std::optional<struct stat> factsA = factsOf(a), factsB = factsOf(b);
    if (factsA && factsB) return same(*factsA, *factsB);
    return !factsA && !factsB && wholePath(a) == wholePath(b);
}

bool isOneOf(const NamedFile& series, const std::string& file) {
    const fs::path pattern = wholePath(series.path), whole = wholePath(file);
    const std::string names = pattern.filename().string(), name = whole.filename().string();
    const size_t star = names.rfind('*');
    const std::string begin = names.substr(0, star), end = names.substr(star + 1);
    if (pattern.parent_path() != whole.parent_path() || name.size() < begin.size() + end.size() + 1 || !name.starts_with(begin) ||
        !name.ends_with(end))
        return false;
    if (!begin.ends_with('_')) return true;  // any name
    // The number of a frame; for a skin's pictures of heights "_height" and a number follow.
    std::string middle = name.substr(begin.size(), name.size() - begin.size() - end.size());
    if (const size_t height = middle.find("_height"); height != std::string::npos) middle.erase(height, 7);
    return std::ranges::all_of(middle, [](char c) { return c >= '0' && c <= '9'; });
}

bool overlap(const NamedFile& a, const NamedFile& b) {
    if (a.series) return !b.series && isOneOf(a, b.path);
    return b.series ? isOneOf(b, a.path) : sameFile(a.path, b.path);
}

// None of these takes part: an empty name; a device, a pipe, or an open descriptor (/dev/stdout), which may be written into by several.
bool isFile(const std::string& path) {
    if (path.empty() || descriptorOf(path)) return false;
    const std::optional<struct stat> facts = factsOf(path);
    return !facts || S_ISREG(facts->st_mode);
}

}  // namespace

Status checkOutputs(std::span<const NamedFile> outputs, std::span<const NamedFile> inputs) {
    constexpr std::pair<int, const char*> kStreams[] = {{STDOUT_FILENO, "standard output"}, {STDERR_FILENO, "standard error"}};
    for (size_t k = 0; k < outputs.size(); ++k) {
        const NamedFile& one = outputs[k];
        if (!isFile(one.path)) continue;
        for (const NamedFile& other : outputs.subspan(k + 1))
            if (isFile(other.path) && overlap(one, other))
                return badInput(fmt::format("{} and {} would both write {}; give each a file of its own", one.option, other.option,
                                            one.series ? other.path : one.path));
        for (const NamedFile& input : inputs)
            if (isFile(input.path) && overlap(one, input))
                return badInput(fmt::format("{} would overwrite {}, which is an input ({}); choose another file name", one.option,
                                            input.path, input.option));
        const std::optional<struct stat> facts = factsOf(one.path);
        for (const auto& [stream, name] : kStreams) {
            struct stat redirected = {};
            if (facts && ::fstat(stream, &redirected) == 0 && same(*facts, redirected))
                return badInput(
                    fmt::format("{} would replace {}, to which {} is redirected; choose another file name", one.option, one.path, name));
        }
    }
    return ok();
}

}  // namespace rivulet
