// Program: shaders from files, uniforms by name, reloaded while the program runs.
//
//     Result<Program> p = Program::create(files, {"shaders/render/mesh.vert", "shaders/render/mesh.frag"});
//     p->use();  p->set("viewProjection", m);  p->texture("shadow", 0, shadowMap);
//
// Shader files have no #version line (450 core is put in front) and may #include "shaders/...".
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/compute/kernel_source.h"
#include "engine/core/math.h"
#include "engine/gpu/gl_object.h"
#include "engine/gpu/texture.h"

namespace rivulet::gpu {

class Program {
  public:
    Program() = default;
    // The file's ending selects the stage: .vert .frag .geom .comp .kernel (compute). Error (failed): the compiler's log, each line with
    // file and line, also in included files; (badInput): a missing file or include.
    static Result<Program> create(const ShaderFiles& files, std::vector<std::string> paths, std::vector<Define> defines = {});

    // Reads the files again. On failure (as create, or a uniform that was set is no longer declared) the last valid program is kept. After
    // success uniforms may have their defaults: set them in each frame.
    Status reload();
    // The same for several programs: on failure none changes. Compiles the programs whose text has changed and returns their number.
    // `fits` is called for each compiled programs[k] with its new GL name; its Error is a failure too.
    using Fits = std::function<Status(size_t k, unsigned name)>;
    static Result<size_t> reload(std::span<Program* const> programs, const Fits& fits = {});

    unsigned name() const { return name_.name(); }
    const std::vector<std::string>& paths() const { return paths_; }
    explicit operator bool() const { return static_cast<bool>(name_); }
    void use() const;

    // use() is not needed, and a value that is already set costs no call of OpenGL. A uniform that the compiler optimised away is ignored;
    // one that no shader declares is a programming error (ASSERT).
    void set(std::string_view uniform, float v);
    void set(std::string_view uniform, int v);  // also bool, and a sampler's unit
    void set(std::string_view uniform, unsigned v);
    void set(std::string_view uniform, const vec2& v);
    void set(std::string_view uniform, const vec3& v);
    void set(std::string_view uniform, const vec4& v);
    void set(std::string_view uniform, const ivec2& v);
    void set(std::string_view uniform, const ivec3& v);
    void set(std::string_view uniform, const mat3& v);
    void set(std::string_view uniform, const mat4& v);
    void set(std::string_view uniform, std::span<const float> v);  // arrays: the name without [0]
    void set(std::string_view uniform, std::span<const vec3> v);
    void set(std::string_view uniform, std::span<const vec4> v);
    void set(std::string_view uniform, std::span<const mat4> v);

    // Binds the texture to the unit and sets the sampler to it.
    void texture(std::string_view sampler, int unit, const Texture& t);

    // Calls use(), then dispatches enough work groups for x * y * z invocations. The caller (the frame graph) places barriers.
    void dispatch(unsigned x, unsigned y = 1, unsigned z = 1);

  private:
    struct Built;
    static Result<std::vector<KernelSource>> read(const ShaderFiles& files, const std::vector<std::string>& paths,
                                                  const std::vector<Define>& defines);
    static Result<Built> build(const std::vector<KernelSource>& sources, const std::vector<std::string>& paths);
    void replaceBy(Built built);
    // What a uniform was last set to; longer values are set again each time.
    struct Uniform {
        int location = -1;  // -1: optimised away
        size_t bytes = 0;   // 0: not known
        std::array<std::byte, sizeof(mat4)> value{};
    };
    Uniform& find(std::string_view uniform);
    // The location, if the uniform is to be set: where it is used, and has another value.
    std::optional<int> changed(std::string_view uniform, std::span<const std::byte> value);

    ShaderFiles files_;
    std::vector<std::string> paths_;
    std::vector<Define> defines_;
    ProgramName name_;
    size_t text_ = 0;           // a hash of the compiled text, to detect changed files
    std::string declarations_;  // all uniform declarations, to distinguish "optimised away" from "unknown"
    std::map<std::string, Uniform, std::less<>> uniforms_;
    uvec3 localSize_{0};  // of a compute program
};

}  // namespace rivulet::gpu
