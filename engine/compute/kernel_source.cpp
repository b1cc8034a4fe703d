#include "engine/compute/kernel_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "engine/compute/embedded_shaders.h"

namespace rivulet {
namespace {

std::string_view trimmed(std::string_view text) {
    while (!text.empty() && std::isspace(static_cast<unsigned char>(text.front()))) text.remove_prefix(1);
    while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back()))) text.remove_suffix(1);
    return text;
}

// "#  name rest" -> {name, rest}; {"", ""} for a line that is no directive.
struct Directive {
    std::string_view name, rest;
};
Directive directiveOf(std::string_view line) {
    line = trimmed(line);
    if (line.empty() || line.front() != '#') return {};
    line = trimmed(line.substr(1));
    size_t end = 0;
    while (end < line.size() && std::isalpha(static_cast<unsigned char>(line[end]))) ++end;
    return {line.substr(0, end), trimmed(line.substr(end))};
}

std::string_view withoutComment(std::string_view condition) {
    return trimmed(condition.substr(0, std::min(condition.find("//"), condition.find("/*"))));
}

// True for a condition that only a C++ compiler can meet: "defined(__cplusplus) [&& ...]".
bool needsCpp(const Directive& d) {
    const std::string_view condition = withoutComment(d.rest);
    if (d.name == "ifdef") return condition == "__cplusplus";
    return condition.starts_with("defined(__cplusplus)") && condition.find("||") == std::string_view::npos;
}
bool refusesCpp(const Directive& d) {
    const std::string_view condition = withoutComment(d.rest);
    if (d.name == "ifndef") return condition == "__cplusplus";
    return condition == "!defined(__cplusplus)";
}

// Inlines includes, depth first. Text that only C++ reads becomes empty lines, so that the C++ side's includes are never looked for.
class Flattener {
  public:
    Flattener(const ShaderFiles& files, Dialect dialect, KernelSource& out) : files_(files), dialect_(dialect), out_(out) {}

    Status inlineFile(const std::string& path, const std::string& text, bool unconditional) {
        const size_t index = indexOf(path);
        if (unconditional) always_[index] = true;
        stack_.push_back(path);
        // The guard makes an include inside a condition safe: only the copy that the compiler reads first takes effect.
        out_.text += fmt::format("#ifndef RIVULET_INCLUDED_{0}\n#define RIVULET_INCLUDED_{0}\n", index);
        writeLine(1, index);

        std::vector<Branch> branches;  // of #if, of this file
        size_t number = 0;
        for (size_t at = 0; at < text.size();) {
            ++number;
            const size_t newline = std::min(text.find('\n', at), text.size());
            std::string_view line(text.data() + at, newline - at);
            at = newline + 1;
            if (line.ends_with('\r')) line.remove_suffix(1);

            const Directive d = directiveOf(line);
            const bool dropped = std::any_of(branches.begin(), branches.end(), [](const Branch& b) { return b.cppOnly; });
            if (d.name == "if" || d.name == "ifdef" || d.name == "ifndef") {
                branches.push_back({!dropped && needsCpp(d), refusesCpp(d), dropped});
                line = dropped ? std::string_view() : line;
            } else if (d.name == "elif" || d.name == "else" || d.name == "endif") {
                if (branches.empty())
                    return badInput(fmt::format("{}:{}: #{} without #if; remove it or add the #if", path, number, d.name));
                Branch& b = branches.back();
                if (b.insideDropped) line = {};
                if (d.name == "elif") b.cppOnly = !b.insideDropped && needsCpp(d);
                if (d.name == "else") b.cppOnly = !b.insideDropped && b.refusedCpp;
                if (d.name == "endif") branches.pop_back();
            } else if (dropped || (d.name == "pragma" && withoutComment(d.rest) == "once")) {
                line = {};
            } else if (d.name == "include") {
                const Status included = include(path, number, d.rest, unconditional && branches.empty());
                if (!included) return included.error();
                writeLine(number + 1, index);
                continue;
            }
            out_.text.append(line);
            out_.text += '\n';
        }
        if (!branches.empty()) return badInput(fmt::format("{}:{}: an #if is never closed; add #endif", path, number));
        out_.text += "#endif\n";
        stack_.pop_back();
        return ok();
    }

  private:
    struct Branch {
        bool cppOnly, refusedCpp, insideDropped;
    };

    size_t indexOf(const std::string& path) {
        const auto found = std::find(out_.files.begin(), out_.files.end(), path);
        const size_t index = static_cast<size_t>(found - out_.files.begin());
        if (found == out_.files.end()) {
            out_.files.push_back(path);
            always_.push_back(false);
        }
        return index;
    }

    void writeLine(size_t number, size_t index) {
        if (dialect_ == Dialect::glsl)
            out_.text += fmt::format("#line {} {}\n", number, index);
        else
            out_.text += fmt::format("#line {} \"{}\"\n", number, out_.files[index]);
    }

    Status include(const std::string& from, size_t number, std::string_view quoted, bool unconditional) {
        const size_t close = quoted.empty() || quoted.front() != '"' ? std::string_view::npos : quoted.find('"', 1);
        if (close == std::string_view::npos)
            return badInput(fmt::format("{}:{}: cannot read this #include; write #include \"shaders/FOLDER/FILE\"", from, number));
        std::string_view named = quoted.substr(1, close - 1);
        // As a host's C++ compiler finds our headers, so that its kernel is one text for all compilers.
        if (named.starts_with("rivulet/shaders/")) named.remove_prefix(std::string_view("rivulet/").size());
        const std::string path(named);
        if (std::find(stack_.begin(), stack_.end(), path) != stack_.end())
            return badInput(fmt::format("{}:{}: \"{}\" includes itself ({} -> {}); remove one of these includes", from, number, path,
                                        fmt::join(stack_, " -> "), path));
        const auto found = std::find(out_.files.begin(), out_.files.end(), path);
        if (found != out_.files.end() && always_[static_cast<size_t>(found - out_.files.begin())]) return ok();
        const Result<std::string> text = files_.load(path);
        if (!text) return badInput(fmt::format("{}:{}: cannot include \"{}\": {}", from, number, path, text.error().message));
        return inlineFile(path, *text, unconditional);
    }

    const ShaderFiles& files_;
    Dialect dialect_;
    KernelSource& out_;
    std::vector<std::string> stack_;
    std::vector<bool> always_;  // by index into out_.files: included outside every condition, so never included again
};

// Reads digits at `at`; false if there are none.
bool readNumber(std::string_view text, size_t& at, size_t& number) {
    const size_t begin = at;
    for (number = 0; at < text.size() && at - begin < 9 && std::isdigit(static_cast<unsigned char>(text[at])); ++at)
        number = number * 10 + static_cast<size_t>(text[at] - '0');
    return at > begin;
}

// The file and line that line `wanted` of source.text comes from, by its #line directives of OpenCL; "" before the first of them.
std::string placeInText(size_t wanted, const KernelSource& source) {
    std::string file;
    size_t number = 0, at = 0;
    for (size_t k = 1; k < wanted && at < source.text.size(); ++k) {
        const size_t newline = std::min(source.text.find('\n', at), source.text.size());
        const Directive d = directiveOf(std::string_view(source.text).substr(at, newline - at));
        at = newline + 1;
        size_t from = 0;
        const size_t quote = d.rest.find('"');
        if (d.name == "line" && quote != std::string_view::npos && readNumber(d.rest, from, number))
            file = d.rest.substr(quote + 1, d.rest.rfind('"') - quote - 1);
        else
            ++number;
    }
    return file.empty() ? file : fmt::format("{}:{}", file, number);
}

std::string readableLine(std::string_view line, const KernelSource& source) {
    size_t at = 0;
    constexpr std::string_view kWhole = "<kernel>:";  // NVIDIA's OpenCL ignores #line and counts the lines of the whole text
    if (line.starts_with(kWhole)) {
        size_t number = 0;
        at = kWhole.size();
        const std::string place = readNumber(line, at, number) ? placeInText(number, source) : std::string();
        return place.empty() ? std::string(line) : fmt::format("{}{}", place, line.substr(at));
    }
    for (const std::string_view prefix : {"ERROR: ", "WARNING: "})
        if (line.starts_with(prefix)) at = prefix.size();
    const std::string_view prefix = line.substr(0, at);
    size_t file = 0, number = 0;
    if (!readNumber(line, at, file) || file >= source.files.size() || at >= line.size()) return std::string(line);
    const char mark = line[at++];
    if ((mark != ':' && mark != '(') || !readNumber(line, at, number)) return std::string(line);
    if (mark == '(') {  // NVIDIA: "0(12) : error C1008: ..."
        if (at >= line.size() || line[at] != ')') return std::string(line);
        at = line.find_first_not_of(" :", at + 1);
        return fmt::format("{}:{}: {}", source.files[file], number, at == std::string_view::npos ? "" : line.substr(at));
    }
    return fmt::format("{}{}:{}{}", prefix, source.files[file], number, line.substr(at));  // Mesa: "0:12(3): error: ..."
}

}  // namespace

ShaderFiles::ShaderFiles(std::string root) : root_(std::move(root)) {}

namespace {

// An installed program, or a host, must not depend on a source tree on the same machine, which may have changed since.
bool runsFromBuildTree() {
    std::error_code ignored;
    return std::filesystem::read_symlink("/proc/self/exe", ignored).string().starts_with(RIVULET_BINARY_DIR "/");
}

}  // namespace

ShaderFiles ShaderFiles::developer() {
    if (const char* root = std::getenv("RIVULET_SHADERS"); root && *root) return ShaderFiles(root);
    std::error_code ignored;
    if (runsFromBuildTree() && std::filesystem::is_directory(RIVULET_SOURCE_DIR "/shaders", ignored))
        return ShaderFiles(RIVULET_SOURCE_DIR);
    return ShaderFiles();
}

Result<std::string> ShaderFiles::load(std::string_view path) const {
    for (size_t k = added_.size(); k-- > 0;)
        if (added_[k].first == path) return added_[k].second;
    if (!root_.empty()) {
        const std::filesystem::path onDisk = std::filesystem::path(root_) / path;
        std::error_code ignored;
        std::ifstream file;
        if (std::filesystem::is_regular_file(onDisk, ignored)) file.open(onDisk, std::ios::binary);
        if (file.is_open()) return std::string(std::istreambuf_iterator<char>(file), {});
    }
    for (const EmbeddedShader& row : embeddedShaders())
        if (path == row.path) return std::string(row.text);
    if (root_.empty()) return badInput(fmt::format("no shader file \"{}\" is embedded in this program; check its name", path));
    return badInput(
        fmt::format("there is no shader file \"{}\" in \"{}\", and none is embedded in this program; check its name", path, root_));
}

Result<KernelSource> ShaderFiles::flatten(std::string_view path, std::span<const Define> defines, Dialect dialect,
                                          std::string_view header) const {
    const Result<std::string> text = load(path);
    if (!text) return text.error();
    KernelSource source;
    source.text = header;
    if (!header.empty() && header.back() != '\n') source.text += '\n';
    for (const Define& define : always_) source.text += fmt::format("#define {} {}\n", define.name, define.value);
    for (const Define& define : defines) source.text += fmt::format("#define {} {}\n", define.name, define.value);
    const Status flattened = Flattener(*this, dialect, source).inlineFile(std::string(path), *text, true);
    if (!flattened) return flattened.error();
    return source;
}

std::string readableLog(std::string_view log, const KernelSource& source) {
    std::string out;
    for (size_t at = 0; at < log.size();) {
        const size_t newline = std::min(log.find('\n', at), log.size());
        out += readableLine(log.substr(at, newline - at), source);
        if (newline < log.size()) out += '\n';
        at = newline + 1;
    }
    return out;
}

std::string shortLog(std::string_view log) {
    constexpr size_t kMostLines = 40, kWidest = 400;
    const auto contains = [](std::string_view line, std::string_view what) {
        const size_t at = line.find(what);
        return at != std::string_view::npos && (at == 0 || line[at - 1] == ' ' || line[at - 1] == ':');
    };
    std::vector<std::string_view> lines, wanted;
    bool any = false, warned = false;  // any: there is an error; warned: the line belongs to a warning
    for (size_t at = 0; at < log.size();) {
        const size_t newline = std::min(log.find('\n', at), log.size());
        const std::string_view line = log.substr(at, newline - at);
        at = newline + 1;
        lines.push_back(line);
        const bool error = contains(line, "error:") || contains(line, "error ") || contains(line, "ERROR:");
        any = any || error;
        warned = !error && (warned || contains(line, "warning:") || contains(line, "warning ") || contains(line, "WARNING:"));
        if (!warned) wanted.push_back(line);
    }
    if (!any) wanted = lines;
    std::string out;
    for (size_t k = 0; k < std::min(wanted.size(), kMostLines); ++k) {
        if (k > 0) out += '\n';
        out += wanted[k].substr(0, kWidest);
        if (wanted[k].size() > kWidest) out += " ...";
    }
    if (wanted.size() > kMostLines) out += fmt::format("\n... and {} more lines", wanted.size() - kMostLines);
    return out;
}

}  // namespace rivulet
