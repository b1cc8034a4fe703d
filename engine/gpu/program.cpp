#include "engine/gpu/program.h"

#include <fmt/format.h>
#include <rivulet_glad/gl.h>

#include <algorithm>
#include <cctype>
#include <optional>
#include <utility>

#include "engine/core/assert.h"

namespace rivulet::gpu {
namespace {

std::optional<GLenum> stageOf(std::string_view path) {
    const std::pair<std::string_view, GLenum> endings[] = {{".vert", GL_VERTEX_SHADER},
                                                           {".frag", GL_FRAGMENT_SHADER},
                                                           {".geom", GL_GEOMETRY_SHADER},
                                                           {".comp", GL_COMPUTE_SHADER},
                                                           {".kernel", GL_COMPUTE_SHADER}};
    for (const auto& [ending, stage] : endings)
        if (path.ends_with(ending)) return stage;
    return std::nullopt;
}

bool partOfWord(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }

// The position of `word` as a whole word at or after `from`.
size_t findWord(std::string_view text, std::string_view word, size_t from = 0) {
    for (size_t at = text.find(word, from); at != std::string_view::npos; at = text.find(word, at + 1)) {
        const size_t end = at + word.size();
        if ((at == 0 || !partOfWord(text[at - 1])) && (end == text.size() || !partOfWord(text[end]))) return at;
    }
    return std::string_view::npos;
}

std::string withoutComments(std::string_view text) {
    std::string out;
    for (size_t at = 0; at < text.size();) {
        if (text.substr(at, 2) == "//") {
            at = std::min(text.find('\n', at), text.size());
        } else if (text.substr(at, 2) == "/*") {
            const size_t close = text.find("*/", at + 2);
            at = close == std::string_view::npos ? text.size() : close + 2;
            out += ' ';
        } else {
            out += text[at++];
        }
    }
    return out;
}

// All declarations, "uniform vec3 a, b;", "uniform Block { ... } c;", also those that a condition removes.
std::string uniformDeclarations(std::string_view source) {
    const std::string text = withoutComments(source);
    std::string out;
    for (size_t at = findWord(text, "uniform"); at != std::string_view::npos; at = findWord(text, "uniform", at)) {
        int depth = 0;
        for (; at < text.size() && (depth > 0 || text[at] != ';'); ++at) {
            depth += text[at] == '{' ? 1 : text[at] == '}' ? -1 : 0;
            out += text[at];
        }
        out += ";\n";
    }
    return out;
}

template <class Get, class GetLog>
std::string infoLog(GLuint name, Get get, GetLog getLog) {
    GLint length = 0;
    get(name, GL_INFO_LOG_LENGTH, &length);
    std::string log(static_cast<size_t>(std::max(length, 1)), '\0');
    getLog(name, length, nullptr, log.data());
    log.resize(log.find_last_not_of(std::string_view(" \n\0", 3)) + 1);
    return log;
}

std::string joined(const std::vector<std::string>& paths) { return fmt::format("{}", fmt::join(paths, " + ")); }

size_t hashOf(const std::vector<KernelSource>& sources) {
    std::string all;
    for (const KernelSource& source : sources) all += source.text;
    return std::hash<std::string>()(all);
}

// "lights[2].colour" -> "lights".
std::string_view baseName(std::string_view uniform) { return uniform.substr(0, uniform.find_first_of(".[")); }

bool declares(std::string_view declarations, std::string_view uniform) {
    return findWord(declarations, baseName(uniform)) != std::string_view::npos;
}

}  // namespace

struct Program::Built {
    ProgramName name;
    std::string declarations;
    size_t text = 0;
};

Result<std::vector<KernelSource>> Program::read(const ShaderFiles& files, const std::vector<std::string>& paths,
                                                const std::vector<Define>& defines) {
    std::vector<KernelSource> sources;
    for (const std::string& path : paths) {
        Result<KernelSource> source = files.flatten(path, defines, Dialect::glsl, "#version 450 core\n");
        if (!source) return source.error();
        sources.push_back(std::move(*source));
    }
    return sources;
}

Result<Program::Built> Program::build(const std::vector<KernelSource>& sources, const std::vector<std::string>& paths) {
    Built built{ProgramName(glCreateProgram()), {}, hashOf(sources)};
    std::vector<ShaderName> shaders;
    for (size_t k = 0; k < paths.size(); ++k) {
        const std::string& path = paths[k];
        const KernelSource* source = &sources[k];
        const std::optional<GLenum> stage = stageOf(path);
        ASSERT(stage, fmt::format("\"{}\": end a shader's name with .vert .frag .geom .comp or .kernel", path).c_str());
        built.declarations += uniformDeclarations(source->text);
        const ShaderName& shader = shaders.emplace_back(glCreateShader(*stage));
        const char* text = source->text.c_str();
        const auto length = static_cast<GLint>(source->text.size());
        glShaderSource(shader.name(), 1, &text, &length);
        glCompileShader(shader.name());
        GLint compiled = GL_FALSE;
        glGetShaderiv(shader.name(), GL_COMPILE_STATUS, &compiled);
        if (compiled == GL_FALSE) {
            const std::string log = infoLog(shader.name(), glGetShaderiv, glGetShaderInfoLog);
            return failed(fmt::format("OpenGL cannot compile {}:\n{}", path, readableLog(log, *source)));
        }
        glAttachShader(built.name.name(), shader.name());
    }
    glLinkProgram(built.name.name());
    for (const ShaderName& shader : shaders) glDetachShader(built.name.name(), shader.name());
    GLint linked = GL_FALSE;
    glGetProgramiv(built.name.name(), GL_LINK_STATUS, &linked);
    if (linked == GL_FALSE)
        return failed(
            fmt::format("OpenGL cannot link {}:\n{}", joined(paths), infoLog(built.name.name(), glGetProgramiv, glGetProgramInfoLog)));
    return built;
}

Result<Program> Program::create(const ShaderFiles& files, std::vector<std::string> paths, std::vector<Define> defines) {
    ASSERT(!paths.empty(), "name at least one shader file");
    Program program;
    program.files_ = files;
    program.paths_ = std::move(paths);
    program.defines_ = std::move(defines);
    const Status loaded = program.reload();
    if (!loaded) return loaded.error();
    return program;
}

Status Program::reload() {
    Program* self = this;
    const Result<size_t> loaded = reload({&self, 1});
    return loaded ? ok() : Status(loaded.error());
}

Result<size_t> Program::reload(std::span<Program* const> programs, const Fits& fits) {
    std::vector<std::pair<Program*, Built>> fresh;
    for (size_t k = 0; k < programs.size(); ++k) {
        Program* program = programs[k];
        const Result<std::vector<KernelSource>> sources = read(program->files_, program->paths_, program->defines_);
        if (!sources) return sources.error();
        if (program->name_ && hashOf(*sources) == program->text_) continue;
        Result<Built> built = build(*sources, program->paths_);
        if (!built) return built.error();
        for (const auto& [uniform, known] : program->uniforms_)
            if (!declares(built->declarations, uniform))
                return failed(fmt::format("{} no longer declares the uniform \"{}\", which the program sets; put it back",
                                          joined(program->paths_), uniform));
        if (const Status fit = fits ? fits(k, built->name.name()) : ok(); !fit) return fit.error();
        fresh.emplace_back(program, std::move(*built));
    }
    for (auto& [program, built] : fresh) program->replaceBy(std::move(built));
    return fresh.size();
}

void Program::replaceBy(Built built) {
    name_ = std::move(built.name);
    text_ = built.text;
    declarations_ = std::move(built.declarations);
    // The names are kept: the next reload must declare every uniform that the program has set.
    for (auto& [uniform, known] : uniforms_) known = {.location = glGetUniformLocation(name(), uniform.c_str())};
    localSize_ = uvec3(0);
    if (stageOf(paths_.front()) == GL_COMPUTE_SHADER) {
        GLint size[3] = {0, 0, 0};
        glGetProgramiv(name(), GL_COMPUTE_WORK_GROUP_SIZE, size);
        localSize_ = uvec3(size[0], size[1], size[2]);
    }
}

Program::Uniform& Program::find(std::string_view uniform) {
    const auto known = uniforms_.find(uniform);
    if (known != uniforms_.end()) return known->second;
    ASSERT(name_, "create the program before setting its uniforms");
    const std::string text(uniform);
    const GLint found = glGetUniformLocation(name(), text.c_str());
    ASSERT(found >= 0 || declares(declarations_, uniform),
           fmt::format("set a uniform that {} declares; \"{}\" is none", joined(paths_), uniform).c_str());
    return uniforms_.emplace(text, Uniform{.location = found}).first->second;
}

void Program::use() const { glUseProgram(name()); }

std::optional<int> Program::changed(std::string_view uniform, std::span<const std::byte> value) {
    Uniform& known = find(uniform);
    if (known.location < 0) return std::nullopt;
    if (value.size() > known.value.size()) {
        known.bytes = 0;
        return known.location;
    }
    if (known.bytes == value.size() && std::equal(value.begin(), value.end(), known.value.begin())) return std::nullopt;
    known.bytes = value.size();
    std::copy(value.begin(), value.end(), known.value.begin());
    return known.location;
}

namespace {
template <class T>
std::span<const std::byte> bytesOf(const T& value) {
    return std::as_bytes(std::span(&value, 1));
}
}  // namespace

void Program::set(std::string_view u, float v) {
    if (const auto at = changed(u, bytesOf(v))) glProgramUniform1f(name(), *at, v);
}
void Program::set(std::string_view u, int v) {
    if (const auto at = changed(u, bytesOf(v))) glProgramUniform1i(name(), *at, v);
}
void Program::set(std::string_view u, unsigned v) {
    if (const auto at = changed(u, bytesOf(v))) glProgramUniform1ui(name(), *at, v);
}
void Program::set(std::string_view u, const vec2& v) {
    if (const auto at = changed(u, bytesOf(v))) glProgramUniform2fv(name(), *at, 1, &v.x);
}
void Program::set(std::string_view u, const vec3& v) {
    if (const auto at = changed(u, bytesOf(v))) glProgramUniform3fv(name(), *at, 1, &v.x);
}
void Program::set(std::string_view u, const vec4& v) {
    if (const auto at = changed(u, bytesOf(v))) glProgramUniform4fv(name(), *at, 1, &v.x);
}
void Program::set(std::string_view u, const ivec2& v) {
    if (const auto at = changed(u, bytesOf(v))) glProgramUniform2iv(name(), *at, 1, &v.x);
}
void Program::set(std::string_view u, const ivec3& v) {
    if (const auto at = changed(u, bytesOf(v))) glProgramUniform3iv(name(), *at, 1, &v.x);
}
void Program::set(std::string_view u, const mat3& v) {
    if (const auto at = changed(u, bytesOf(v))) glProgramUniformMatrix3fv(name(), *at, 1, GL_FALSE, &v[0].x);
}
void Program::set(std::string_view u, const mat4& v) {
    if (const auto at = changed(u, bytesOf(v))) glProgramUniformMatrix4fv(name(), *at, 1, GL_FALSE, &v[0].x);
}
void Program::set(std::string_view u, std::span<const float> v) {
    if (const auto at = changed(u, std::as_bytes(v))) glProgramUniform1fv(name(), *at, static_cast<GLsizei>(v.size()), v.data());
}
void Program::set(std::string_view u, std::span<const vec3> v) {
    if (v.empty()) return;
    if (const auto at = changed(u, std::as_bytes(v))) glProgramUniform3fv(name(), *at, static_cast<GLsizei>(v.size()), &v[0].x);
}
void Program::set(std::string_view u, std::span<const vec4> v) {
    if (v.empty()) return;
    if (const auto at = changed(u, std::as_bytes(v))) glProgramUniform4fv(name(), *at, static_cast<GLsizei>(v.size()), &v[0].x);
}
void Program::set(std::string_view u, std::span<const mat4> v) {
    if (v.empty()) return;
    if (const auto at = changed(u, std::as_bytes(v)))
        glProgramUniformMatrix4fv(name(), *at, static_cast<GLsizei>(v.size()), GL_FALSE, &v[0][0].x);
}

void Program::texture(std::string_view sampler, int unit, const Texture& t) {
    set(sampler, unit);
    t.bind(static_cast<GLuint>(unit));
}

void Program::dispatch(unsigned x, unsigned y, unsigned z) {
    ASSERT(localSize_.x > 0, "dispatch a program that has a compute shader");
    if (x == 0 || y == 0 || z == 0) return;
    const uvec3 groups((x - 1) / localSize_.x + 1, (y - 1) / localSize_.y + 1, (z - 1) / localSize_.z + 1);
    ASSERT(groups.x <= 65535 && groups.y <= 65535 && groups.z <= 65535, "dispatch at most 65535 work groups along an axis");
    use();
    glDispatchCompute(groups.x, groups.y, groups.z);
}

}  // namespace rivulet::gpu
