// The source of a kernel or shader: includes are inlined, defines are put in front, and #line directives keep the line numbers, so that an
// error names its file. Files are read from disk in a developer build (hot reload) and embedded in an installed one.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/compute/device.h"
#include "engine/core/result.h"

namespace rivulet {

enum class Dialect { glsl, openclC };

struct KernelSource {
    std::string text;                // with #line directives
    std::vector<std::string> files;  // GLSL's #line has a file number: an index into this list
};

// Finds shader files by path from the project's root ("shaders/common/lang.h"). An #include may also name ours as a host's C++ compiler
// finds them: "rivulet/shaders/common/lang.h".
class ShaderFiles {
  public:
    // `root`: a folder that is searched before the embedded copies; "": the embedded copies only.
    explicit ShaderFiles(std::string root = {});
    // The root is the environment variable RIVULET_SHADERS; else, for a program in the build folder, its source tree; else "".
    static ShaderFiles developer();
    // Adds a file, or replaces one, for devices made afterwards: for example a host's own kernel "shaders/mine/gust.kernel", with a KERNEL
    // named gust.
    void add(std::string path, std::string text) { added_.emplace_back(std::move(path), std::move(text)); }
    // Adds a define in front of every source that is flattened from now on.
    void define(Define define) { always_.push_back(std::move(define)); }
    const std::string& root() const { return root_; }
    // The text of a file. Error (badInput): there is no such file.
    Result<std::string> load(std::string_view path) const;
    // The text of `path`, for example "shaders/fluid/grid/reorder.kernel", with each of its includes inlined once. `header` is put in front
    // of everything, for example "#version 450 core\n". Error (badInput): a missing file, a circular include, an unclosed #if.
    Result<KernelSource> flatten(std::string_view path, std::span<const Define> defines, Dialect dialect,
                                 std::string_view header = {}) const;

  private:
    std::string root_;
    std::vector<std::pair<std::string, std::string>> added_;  // path, text; the last of a path counts
    std::vector<Define> always_;
};

// Replaces "3(12)" or "3:12" (file number, line) in a GLSL log by "shaders/fluid/sph.h:12".
std::string readableLog(std::string_view log, const KernelSource& source);

// A compiler's log of at most 40 lines, without warnings if it has errors; the number of omitted lines is added.
std::string shortLog(std::string_view log);

}  // namespace rivulet
