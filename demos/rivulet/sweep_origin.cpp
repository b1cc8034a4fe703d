#include "demos/rivulet/sweep_origin.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <span>
#include <vector>

#include "engine/compute/disk_cache.h"
#include "engine/core/file.h"
#include "engine/core/file_system.h"
#include "engine/core/input_file.h"
#include "engine/core/json_parse.h"
#include "engine/core/json_text.h"

namespace rivulet {

namespace {

namespace fs = std::filesystem;

constexpr const char* kRemedy = "choose another --output, or delete the folder";

// The hash of a file's bytes; of a long file, which need not fit into memory, that of the hashes of its parts.
Result<std::string> hashOfFile(const std::string& name) {
    constexpr size_t kPart = size_t{64} << 20U;
    const Result<Descriptor> file = openInput(name);
    if (!file) return file.error();
    std::string hashes;
    std::vector<std::byte> part(static_cast<size_t>(std::min<uint64_t>(kPart, factsOf(*file).bytes + 1)));
    for (uint64_t at = 0;;) {
        size_t filled = 0;
        while (filled < part.size()) {
            const std::ptrdiff_t got = readAt(*file, part.data() + filled, part.size() - filled, at + filled);
            if (got < 0) return badInput(fmt::format("{} cannot be read: {}", name, reasonOf(errno)));
            if (got == 0) break;
            filled += static_cast<size_t>(got);
        }
        if (filled > 0 || at == 0) hashes += hashOf(std::span(part).first(filled));
        at += filled;
        if (filled < part.size()) return at <= kPart ? hashes : hashOf(std::as_bytes(std::span(hashes)));
    }
}

}  // namespace

std::string originName(const std::string& file, const std::string& folder) {
    std::error_code error;
    const fs::path whole = fs::absolute(file, error).lexically_normal();
    if (error) return file;
    const fs::path below = whole.lexically_relative(folder);
    return below.empty() || below.begin()->string() == ".." ? whole.string() : below.string();
}

Status hashScenes(SweepOrigin& origin) {
    for (auto& [name, hash] : origin.scenes) {
        Result<std::string> made = hashOfFile((fs::path(origin.folder) / name).string());
        if (!made) return made.error();
        hash = std::move(*made);
    }
    return ok();
}

Result<SweepOrigin> readOrigin(const std::string& file) {
    const Result<std::string> text = readFile(file);
    if (!text) return text.error();
    const Result<Json::Value> root = parseJson(*text, file);
    if (!root) return root.error();
    const Error damaged = badInput(fmt::format("{} is damaged; {}", file, kRemedy));
    if (!root->isObject() || !(*root)["folder"].isString() || !(*root)["version"].isString() || !(*root)["scenes"].isObject())
        return damaged;
    SweepOrigin origin{.folder = (*root)["folder"].asString(), .version = (*root)["version"].asString(), .scenes = {}};
    const Json::Value& scenes = (*root)["scenes"];
    for (const std::string& name : scenes.getMemberNames()) {
        if (!scenes[name].isString()) return damaged;
        origin.scenes.emplace(name, scenes[name].asString());
    }
    return origin;
}

Status writeOrigin(const SweepOrigin& origin, const std::string& file) {
    Json::Value root;
    root["folder"] = origin.folder;
    root["version"] = origin.version;
    root["scenes"] = Json::Value(Json::objectValue);
    for (const auto& [name, hash] : origin.scenes) root["scenes"][name] = hash;
    constexpr int kDigits = 9;
    return writeFileAtomic(file, jsonText(root, kDigits));
}

Status checkOrigin(const SweepOrigin& origin, const std::string& folder, const std::string& tasks) {
    if (origin.version != RIVULET_VERSION)
        return badInput(fmt::format("the tasks in {} were made by version {} of rivulet, and this is {}; {}", tasks, origin.version,
                                    RIVULET_VERSION, kRemedy));
    for (const auto& [name, hash] : origin.scenes) {
        const std::string file = (fs::path(folder) / name).string();
        const Result<std::string> now = hashOfFile(file);
        if (!now)
            return badInput(
                fmt::format("a file that the tasks in {} read is missing: {}; restore it, or {}", tasks, now.error().message, kRemedy));
        if (*now != hash)
            return badInput(fmt::format("{} is not the file that the tasks in {} were made with; restore it, or {}", file, tasks, kRemedy));
    }
    return ok();
}

}  // namespace rivulet
