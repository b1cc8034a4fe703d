// A kernel's text: includes flattened, defines in front, line numbers kept, so that an error names the file it comes from.
// Read from disk in a developer build (hot reload), embedded in an installed one.
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
    std::vector<std::string> files;  // GLSL's #line names files by number: an index into this
};

// Finds shader files by path from the project's root ("shaders/common/lang.h").
class ShaderFiles {
  public:
    // Empty `root`: the embedded copies only; else files under root come first.
    explicit ShaderFiles(std::string root = {});
    // RIVULET_SHADERS from the environment; else, of a program in the build folder, the source tree it came from; else the embedded copies.
    static ShaderFiles developer();
    // A file that is nowhere else, or stands for another, e.g. a host's own kernel ("shaders/mine/gust.kernel", its KERNEL named gust). For
    // devices made after.
    void add(std::string path, std::string text) { added_.emplace_back(std::move(path), std::move(text)); }
    // A define that every text flattened from now on has, before its own.
    void define(Define define) { always_.push_back(std::move(define)); }
    const std::string& root() const { return root_; }
    Result<std::string> load(std::string_view path) const;
    // `path` e.g. "shaders/fluid/grid/reorder.kernel". Each include is taken once. `header` goes before everything (e.g. "#version 450
    // core\n").
    Result<KernelSource> flatten(std::string_view path, std::span<const Define> defines, Dialect dialect,
                                 std::string_view header = {}) const;

  private:
    std::string root_;
    std::vector<std::pair<std::string, std::string>> added_;  // path, text; the last of a path counts
    std::vector<Define> always_;
};

// Rewrites "3(12)" or "3:12" (file number, line) of a GLSL log into "shaders/fluid/sph.h:12".
std::string readableLog(std::string_view log, const KernelSource& source);

// A compiler's log without its warnings, where there are errors to say, and no longer than a screen; what is left out is counted.
std::string shortLog(std::string_view log);

}  // namespace rivulet
