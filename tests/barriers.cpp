#include "tests/barriers.h"

#include <dlfcn.h>
#include <rivulet_glad/gl.h>

#include <array>
#include <map>
#include <mutex>
#include <set>
#include <string_view>

#include "tests/replaced_gl.h"

namespace rivulet::barriers {
namespace {

// The driver's own functions, by which the watch also asks for state.
#define WATCH_OWN(name) decltype(::name) own_##name = nullptr
WATCH_OWN(glGetIntegerv);
WATCH_OWN(glGetIntegeri_v);
WATCH_OWN(glGetProgramInterfaceiv);
WATCH_OWN(glGetProgramResourceiv);
WATCH_OWN(glGetProgramResourceName);
WATCH_OWN(glGetUniformiv);
WATCH_OWN(glGetUniformuiv);
WATCH_OWN(glGetVertexAttribiv);
WATCH_OWN(glGetTextureLevelParameteriv);
WATCH_OWN(glGetAttachedShaders);

// A number that grows with each use; the use of a bit of glMemoryBarrier is numbered too.
using Turn = uint64_t;

// The bits of glMemoryBarrier that uses need.
enum Bit : size_t { attribute, element, uniform, fetch, image, command, pixels, textureUpdate, bufferUpdate, storage, kBits };
constexpr std::array<GLbitfield, kBits> kMasks = {
    GL_VERTEX_ATTRIB_ARRAY_BARRIER_BIT, GL_ELEMENT_ARRAY_BARRIER_BIT, GL_UNIFORM_BARRIER_BIT,      GL_TEXTURE_FETCH_BARRIER_BIT,
    GL_SHADER_IMAGE_ACCESS_BARRIER_BIT, GL_COMMAND_BARRIER_BIT,       GL_PIXEL_BUFFER_BARRIER_BIT, GL_TEXTURE_UPDATE_BARRIER_BIT,
    GL_BUFFER_UPDATE_BARRIER_BIT,       GL_SHADER_STORAGE_BARRIER_BIT};
constexpr std::array<const char*, kBits> kBitNames = {
    "GL_VERTEX_ATTRIB_ARRAY_BARRIER_BIT", "GL_ELEMENT_ARRAY_BARRIER_BIT", "GL_UNIFORM_BARRIER_BIT",      "GL_TEXTURE_FETCH_BARRIER_BIT",
    "GL_SHADER_IMAGE_ACCESS_BARRIER_BIT", "GL_COMMAND_BARRIER_BIT",       "GL_PIXEL_BUFFER_BARRIER_BIT", "GL_TEXTURE_UPDATE_BARRIER_BIT",
    "GL_BUFFER_UPDATE_BARRIER_BIT",       "GL_SHADER_STORAGE_BARRIER_BIT"};

// A buffer or a texture.
struct Memory {
    Turn stored = 0;  // by a shader, last
    Turn used = 0;    // last
    std::string storedBy, usedBy;
};

// What a program does with memory: found when it is first used.
struct Block {
    std::string name;
    GLint binding = 0;
    bool stores = false;
};
struct Sampler {
    GLint location = 0;
    bool ofBuffer = false;  // else an image variable
    bool stores = false;
    std::string name;
};
struct Program {
    std::string name, text;
    GLint groupBase = -1;  // location of lang.h's groupBase_
    bool known = false;
    std::vector<Block> storages, uniforms;
    std::vector<Sampler> samplers;
    std::vector<GLint> attributes;
};

// Of a context. Contexts that share objects are watched one by one, so that a store in one and a use in another is not seen.
struct Context {
    std::map<GLuint, Memory> buffers, textures;
    std::map<GLuint, Program> programs;
    std::map<GLuint, std::string> shaders;  // their texts
    std::array<Turn, kBits> barrier{};      // the last with that bit
};

std::mutex lock;
std::map<void*, Context> contexts;
Turn turn = 0;
Watched counts;
std::set<std::string> reported;
std::vector<std::string> missing;
size_t leaveOut = 0;

Context& here() { return contexts[eglGetCurrentContext()]; }

void report(const std::string& sentence) {
    if (reported.insert(sentence).second) missing.push_back(sentence);
}

// Within a dispatch or draw, uses are not ordered: only those before it count.
Turn commandBegan = 0;

// A use of `bit`'s kind by `who`; `stores`: by a shader.
void use(std::map<GLuint, Memory>& all, GLuint name, Bit bit, bool stores, const std::string& who, const std::string& what) {
    if (name == 0) return;
    Context& c = here();
    Memory& m = all[name];
    ++counts.uses;
    if (m.stored > c.barrier[bit] && m.stored <= commandBegan)
        report(who + (stores ? " writes " : " reads ") + what + ", which " + m.storedBy + " wrote, without " + kBitNames[bit] +
               " in between");
    else if (stores && m.used > c.barrier[bit] && m.used <= commandBegan)
        report(who + " writes " + what + ", which " + m.usedBy + " used, without " + kBitNames[bit] + " in between");
    if (stores) {
        m.stored = ++turn;
        m.storedBy = who;
    } else if (bit != bufferUpdate && bit != textureUpdate && bit != pixels) {  // transfers are in order with what comes after them
        m.used = ++turn;
        m.usedBy = who;
    }
}
void useBuffer(GLuint name, Bit bit, bool stores, const std::string& who, const std::string& what) {
    use(here().buffers, name, bit, stores, who, what);
}

GLint state(GLenum what) {
    GLint value = 0;
    own_glGetIntegerv(what, &value);
    return value;
}
GLint stateAt(GLenum what, GLint index) {
    GLint value = 0;
    own_glGetIntegeri_v(what, static_cast<GLuint>(index), &value);
    return value;
}

bool partOfWord(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

// The text with macros of ARGS as they are: a kernel's row is RO(1, CellStart, ...) or RW(2, ...); elsewhere "readonly buffer CellStart".
bool readsOnly(const std::string& text, const std::string& block) {
    bool found = false;
    for (size_t at = text.find(block); at != std::string::npos; at = text.find(block, at + 1)) {
        const size_t end = at + block.size();
        if (at == 0 || partOfWord(text[at - 1]) || end >= text.size() || partOfWord(text[end])) continue;
        const std::string before = text.substr(at > 60 ? at - 60 : 0, at > 60 ? 60 : at);
        const size_t row = before.rfind('('), qualifier = before.rfind("buffer ");
        if (row != std::string::npos && row >= 2 && before.find(')', row) == std::string::npos) {
            if (before.compare(row - 2, 2, "RW") == 0) return false;
            found |= before.compare(row - 2, 2, "RO") == 0;
        } else if (qualifier != std::string::npos && qualifier + 7 == before.size()) {
            if (qualifier < 9 || before.compare(qualifier - 9, 9, "readonly ") != 0) return false;
            found = true;
        }
    }
    return found;
}

// "flow/paint" of a flattened kernel: the file of the line above KERNEL. Else the program's number.
std::string nameOf(const std::string& text, GLuint number) {
    const size_t kernel = text.rfind("\nKERNEL(");
    if (kernel == std::string::npos) return "program " + std::to_string(number);
    const size_t from = kernel + 8, to = text.find_first_of(",)", from);
    return "kernel " + text.substr(from, to - from);
}

GLint property(GLuint program, GLenum of, GLint index, GLenum what) {
    GLint value = 0;
    own_glGetProgramResourceiv(program, of, static_cast<GLuint>(index), 1, &what, 1, nullptr, &value);
    return value;
}
GLint resources(GLuint program, GLenum of) {
    GLint count = 0;
    own_glGetProgramInterfaceiv(program, of, GL_ACTIVE_RESOURCES, &count);
    return count;
}
std::string resourceName(GLuint program, GLenum of, GLint index) {
    char name[256] = "";
    own_glGetProgramResourceName(program, of, static_cast<GLuint>(index), sizeof name, nullptr, name);
    return name;
}

bool isBufferSampler(GLint type) {
    return type == GL_SAMPLER_BUFFER || type == GL_INT_SAMPLER_BUFFER || type == GL_UNSIGNED_INT_SAMPLER_BUFFER;
}
bool isImage(GLint type) { return type >= GL_IMAGE_1D && type <= GL_UNSIGNED_INT_IMAGE_2D_MULTISAMPLE_ARRAY; }

Program& programInUse(GLuint number) {
    Program& p = here().programs[number];
    if (p.known) return p;
    p.known = true;
    p.name = nameOf(p.text, number);
    for (GLint k = 0; k < resources(number, GL_SHADER_STORAGE_BLOCK); ++k) {
        const std::string name = resourceName(number, GL_SHADER_STORAGE_BLOCK, k);
        p.storages.push_back({name, property(number, GL_SHADER_STORAGE_BLOCK, k, GL_BUFFER_BINDING), !readsOnly(p.text, name)});
    }
    for (GLint k = 0; k < resources(number, GL_UNIFORM_BLOCK); ++k)
        p.uniforms.push_back({resourceName(number, GL_UNIFORM_BLOCK, k), property(number, GL_UNIFORM_BLOCK, k, GL_BUFFER_BINDING), false});
    for (GLint k = 0; k < resources(number, GL_UNIFORM); ++k) {
        const GLint type = property(number, GL_UNIFORM, k, GL_TYPE);
        if (resourceName(number, GL_UNIFORM, k) == "groupBase_") p.groupBase = property(number, GL_UNIFORM, k, GL_LOCATION);
        if (!isBufferSampler(type) && !isImage(type)) continue;
        const std::string name = resourceName(number, GL_UNIFORM, k);
        const size_t declared = p.text.rfind("image", p.text.find(' ' + name.substr(0, name.find('[')) + ';'));
        const bool readonly =
            declared != std::string::npos &&
            p.text.substr(p.text.rfind('\n', declared) + 1, declared - p.text.rfind('\n', declared)).find("readonly") != std::string::npos;
        p.samplers.push_back({property(number, GL_UNIFORM, k, GL_LOCATION), isBufferSampler(type), isImage(type) && !readonly, name});
    }
    for (GLint k = 0; k < resources(number, GL_PROGRAM_INPUT); ++k)
        if (const GLint location = property(number, GL_PROGRAM_INPUT, k, GL_LOCATION); location >= 0) p.attributes.push_back(location);
    return p;
}

// Whether a dispatch continues the one before: Device gl divides one of very many groups.
bool continues() {
    const auto number = static_cast<GLuint>(state(GL_CURRENT_PROGRAM));
    GLuint base = 0;
    if (number != 0 && programInUse(number).groupBase >= 0) own_glGetUniformuiv(number, programInUse(number).groupBase, &base);
    return base > 0;
}

// All that the program in use reads and writes. Reads come first: a shader may store where it loads.
void useProgram() {
    const auto number = static_cast<GLuint>(state(GL_CURRENT_PROGRAM));
    if (number == 0) return;
    const Program& p = programInUse(number);
    for (const Block& b : p.uniforms) {
        const auto buffer = static_cast<GLuint>(stateAt(GL_UNIFORM_BUFFER_BINDING, b.binding));
        useBuffer(buffer, uniform, false, p.name, "the uniform buffer " + b.name);
    }
    for (const Sampler& s : p.samplers) {
        GLint unit = 0;
        own_glGetUniformiv(number, s.location, &unit);
        if (s.ofBuffer) {
            const auto texture = static_cast<GLuint>(stateAt(GL_TEXTURE_BINDING_BUFFER, unit));
            GLint buffer = 0;
            if (texture != 0) own_glGetTextureLevelParameteriv(texture, 0, GL_TEXTURE_BUFFER_DATA_STORE_BINDING, &buffer);
            useBuffer(static_cast<GLuint>(buffer), fetch, false, p.name, "the buffer texture " + s.name);
        } else {
            use(here().textures, static_cast<GLuint>(stateAt(GL_IMAGE_BINDING_NAME, unit)), image, s.stores, p.name, "the image " + s.name);
        }
    }
    for (const bool stores : {false, true})
        for (const Block& b : p.storages)
            if (b.stores == stores)
                useBuffer(static_cast<GLuint>(stateAt(GL_SHADER_STORAGE_BUFFER_BINDING, b.binding)), storage, stores, p.name,
                          "the storage buffer " + b.name);
}

void useVertices(bool indexed) {
    const auto number = static_cast<GLuint>(state(GL_CURRENT_PROGRAM));
    if (number == 0) return;
    const Program& p = programInUse(number);
    for (const GLint location : p.attributes) {
        GLint enabled = 0, buffer = 0;
        own_glGetVertexAttribiv(static_cast<GLuint>(location), GL_VERTEX_ATTRIB_ARRAY_ENABLED, &enabled);
        if (enabled == 0) continue;
        own_glGetVertexAttribiv(static_cast<GLuint>(location), GL_VERTEX_ATTRIB_ARRAY_BUFFER_BINDING, &buffer);
        useBuffer(static_cast<GLuint>(buffer), attribute, false, p.name, "the attribute " + std::to_string(location));
    }
    if (indexed) useBuffer(static_cast<GLuint>(state(GL_ELEMENT_ARRAY_BUFFER_BINDING)), element, false, p.name, "the indices");
}

void drawn(bool indexed, bool indirect) {
    const std::scoped_lock guard(lock);
    ++counts.draws;
    commandBegan = turn;
    useVertices(indexed);
    if (indirect) useBuffer(static_cast<GLuint>(state(GL_DRAW_INDIRECT_BUFFER_BINDING)), command, false, "a draw", "its arguments");
    useProgram();
}

void copied(GLuint buffer, const char* who) {
    const std::scoped_lock guard(lock);
    ++counts.copies;
    commandBegan = turn;
    useBuffer(buffer, bufferUpdate, false, who, "a buffer");
}

void texels(GLenum binding, const char* who) {
    const std::scoped_lock guard(lock);
    commandBegan = turn;
    useBuffer(static_cast<GLuint>(state(binding)), pixels, false, who, "its buffer");
}
void texture(GLuint name, const char* who) {
    const std::scoped_lock guard(lock);
    use(here().textures, name, textureUpdate, false, who, "a texture");
}

// The functions that are watched, each with the driver's own beside it.
#define WATCH(result, name, ...)                             \
    result(GLAD_API_PTR* own_##name)(__VA_ARGS__) = nullptr; \
    result GLAD_API_PTR watch_##name(__VA_ARGS__)

WATCH(void, glMemoryBarrier, GLbitfield bits) {
    {
        const std::scoped_lock guard(lock);
        if (leaveOut > 0 && --leaveOut == 0) return;
        ++counts.barriers;
        ++turn;
        for (size_t b = 0; b < kBits; ++b)
            if ((bits & kMasks[b]) != 0) here().barrier[b] = turn;
    }
    own_glMemoryBarrier(bits);
}
WATCH(void, glDispatchCompute, GLuint x, GLuint y, GLuint z) {
    {
        const std::scoped_lock guard(lock);
        ++counts.dispatches;
        if (!continues()) commandBegan = turn;
        useProgram();
    }
    own_glDispatchCompute(x, y, z);
}
WATCH(void, glDispatchComputeIndirect, GLintptr offset) {
    {
        const std::scoped_lock guard(lock);
        ++counts.dispatches;
        commandBegan = turn;
        useBuffer(static_cast<GLuint>(state(GL_DISPATCH_INDIRECT_BUFFER_BINDING)), command, false, "a dispatch", "its arguments");
        useProgram();
    }
    own_glDispatchComputeIndirect(offset);
}
WATCH(void, glDrawArrays, GLenum mode, GLint first, GLsizei count) {
    drawn(false, false);
    own_glDrawArrays(mode, first, count);
}
WATCH(void, glDrawArraysInstanced, GLenum mode, GLint first, GLsizei count, GLsizei instances) {
    drawn(false, false);
    own_glDrawArraysInstanced(mode, first, count, instances);
}
WATCH(void, glDrawArraysIndirect, GLenum mode, const void* indirect) {
    drawn(false, true);
    own_glDrawArraysIndirect(mode, indirect);
}
WATCH(void, glDrawElements, GLenum mode, GLsizei count, GLenum type, const void* indices) {
    drawn(true, false);
    own_glDrawElements(mode, count, type, indices);
}
WATCH(void, glDrawElementsInstanced, GLenum mode, GLsizei count, GLenum type, const void* indices, GLsizei instances) {
    drawn(true, false);
    own_glDrawElementsInstanced(mode, count, type, indices, instances);
}
WATCH(void, glDrawElementsIndirect, GLenum mode, GLenum type, const void* indirect) {
    drawn(true, true);
    own_glDrawElementsIndirect(mode, type, indirect);
}
WATCH(void, glCopyNamedBufferSubData, GLuint from, GLuint to, GLintptr fromOffset, GLintptr toOffset, GLsizeiptr bytes) {
    copied(from, "glCopyNamedBufferSubData");
    copied(to, "glCopyNamedBufferSubData");
    own_glCopyNamedBufferSubData(from, to, fromOffset, toOffset, bytes);
}
WATCH(void, glNamedBufferSubData, GLuint buffer, GLintptr offset, GLsizeiptr bytes, const void* data) {
    copied(buffer, "glNamedBufferSubData");
    own_glNamedBufferSubData(buffer, offset, bytes, data);
}
WATCH(void, glGetNamedBufferSubData, GLuint buffer, GLintptr offset, GLsizeiptr bytes, void* data) {
    copied(buffer, "glGetNamedBufferSubData");
    own_glGetNamedBufferSubData(buffer, offset, bytes, data);
}
WATCH(void, glClearNamedBufferData, GLuint buffer, GLenum internal, GLenum format, GLenum type, const void* data) {
    copied(buffer, "glClearNamedBufferData");
    own_glClearNamedBufferData(buffer, internal, format, type, data);
}
WATCH(void*, glMapNamedBufferRange, GLuint buffer, GLintptr offset, GLsizeiptr bytes, GLbitfield access) {
    copied(buffer, "glMapNamedBufferRange");
    return own_glMapNamedBufferRange(buffer, offset, bytes, access);
}
WATCH(void, glTextureSubImage2D, GLuint to, GLint level, GLint x, GLint y, GLsizei width, GLsizei height, GLenum format, GLenum type,
      const void* data) {
    texels(GL_PIXEL_UNPACK_BUFFER_BINDING, "glTextureSubImage2D");
    texture(to, "glTextureSubImage2D");
    own_glTextureSubImage2D(to, level, x, y, width, height, format, type, data);
}
WATCH(void, glTextureSubImage3D, GLuint to, GLint level, GLint x, GLint y, GLint z, GLsizei width, GLsizei height, GLsizei depth,
      GLenum format, GLenum type, const void* data) {
    texels(GL_PIXEL_UNPACK_BUFFER_BINDING, "glTextureSubImage3D");
    texture(to, "glTextureSubImage3D");
    own_glTextureSubImage3D(to, level, x, y, z, width, height, depth, format, type, data);
}
WATCH(void, glReadPixels, GLint x, GLint y, GLsizei width, GLsizei height, GLenum format, GLenum type, void* data) {
    texels(GL_PIXEL_PACK_BUFFER_BINDING, "glReadPixels");
    own_glReadPixels(x, y, width, height, format, type, data);
}
WATCH(void, glGetTextureSubImage, GLuint from, GLint level, GLint x, GLint y, GLint z, GLsizei width, GLsizei height, GLsizei depth,
      GLenum format, GLenum type, GLsizei bytes, void* data) {
    texels(GL_PIXEL_PACK_BUFFER_BINDING, "glGetTextureSubImage");
    texture(from, "glGetTextureSubImage");
    own_glGetTextureSubImage(from, level, x, y, z, width, height, depth, format, type, bytes, data);
}
WATCH(void, glCreateBuffers, GLsizei count, GLuint* names) {
    own_glCreateBuffers(count, names);
    const std::scoped_lock guard(lock);
    for (GLsizei k = 0; k < count; ++k) here().buffers.erase(names[k]);
}
WATCH(void, glGenBuffers, GLsizei count, GLuint* names) {
    own_glGenBuffers(count, names);
    const std::scoped_lock guard(lock);
    for (GLsizei k = 0; k < count; ++k) here().buffers.erase(names[k]);
}
WATCH(void, glCreateTextures, GLenum target, GLsizei count, GLuint* names) {
    own_glCreateTextures(target, count, names);
    const std::scoped_lock guard(lock);
    for (GLsizei k = 0; k < count; ++k) here().textures.erase(names[k]);
}
WATCH(void, glShaderSource, GLuint shader, GLsizei count, const GLchar* const* texts, const GLint* lengths) {
    own_glShaderSource(shader, count, texts, lengths);
    const std::scoped_lock guard(lock);
    std::string& all = here().shaders[shader];
    all.clear();
    for (GLsizei k = 0; k < count; ++k)
        all += lengths != nullptr && lengths[k] >= 0 ? std::string(texts[k], static_cast<size_t>(lengths[k])) : std::string(texts[k]);
}
WATCH(void, glLinkProgram, GLuint program) {
    own_glLinkProgram(program);
    const std::scoped_lock guard(lock);
    Context& c = here();
    Program& p = c.programs[program] = {};
    GLuint attached[8] = {};
    GLsizei count = 0;
    own_glGetAttachedShaders(program, 8, &count, attached);
    for (GLsizei k = 0; k < count; ++k) p.text += c.shaders[attached[k]];
}

const testing::ReplacedGl rows[] = {
    REPLACED_GL(watch, glMemoryBarrier),
    REPLACED_GL(watch, glDispatchCompute),
    REPLACED_GL(watch, glDispatchComputeIndirect),
    REPLACED_GL(watch, glDrawArrays),
    REPLACED_GL(watch, glDrawArraysInstanced),
    REPLACED_GL(watch, glDrawArraysIndirect),
    REPLACED_GL(watch, glDrawElements),
    REPLACED_GL(watch, glDrawElementsInstanced),
    REPLACED_GL(watch, glDrawElementsIndirect),
    REPLACED_GL(watch, glCopyNamedBufferSubData),
    REPLACED_GL(watch, glNamedBufferSubData),
    REPLACED_GL(watch, glGetNamedBufferSubData),
    REPLACED_GL(watch, glClearNamedBufferData),
    REPLACED_GL(watch, glMapNamedBufferRange),
    REPLACED_GL(watch, glTextureSubImage2D),
    REPLACED_GL(watch, glTextureSubImage3D),
    REPLACED_GL(watch, glReadPixels),
    REPLACED_GL(watch, glGetTextureSubImage),
    REPLACED_GL(watch, glCreateBuffers),
    REPLACED_GL(watch, glGenBuffers),
    REPLACED_GL(watch, glCreateTextures),
    REPLACED_GL(watch, glShaderSource),
    REPLACED_GL(watch, glLinkProgram),
};

template <class F>
void keep(F& own, testing::GlFunction (*find)(const char*), const char* name) {
    own = reinterpret_cast<F>(find(name));
}

}  // namespace

Watched watched() {
    const std::scoped_lock guard(lock);
    return counts;
}

std::vector<std::string> takeMissing() {
    const std::scoped_lock guard(lock);
    std::vector<std::string> taken;
    taken.swap(missing);
    reported.clear();
    return taken;
}

void leaveOutBarrier(size_t n) {
    const std::scoped_lock guard(lock);
    leaveOut = n;
}

}  // namespace rivulet::barriers

extern "C" rivulet::testing::GlFunction eglGetProcAddress(const char* name) {
    using namespace rivulet::barriers;
    static const auto find = reinterpret_cast<rivulet::testing::GlFunction (*)(const char*)>(dlsym(RTLD_NEXT, "eglGetProcAddress"));
    if (own_glGetIntegerv == nullptr) {
        keep(own_glGetIntegerv, find, "glGetIntegerv");
        keep(own_glGetIntegeri_v, find, "glGetIntegeri_v");
        keep(own_glGetProgramInterfaceiv, find, "glGetProgramInterfaceiv");
        keep(own_glGetProgramResourceiv, find, "glGetProgramResourceiv");
        keep(own_glGetProgramResourceName, find, "glGetProgramResourceName");
        keep(own_glGetUniformiv, find, "glGetUniformiv");
        keep(own_glGetUniformuiv, find, "glGetUniformuiv");
        keep(own_glGetVertexAttribiv, find, "glGetVertexAttribiv");
        keep(own_glGetTextureLevelParameteriv, find, "glGetTextureLevelParameteriv");
        keep(own_glGetAttachedShaders, find, "glGetAttachedShaders");
    }
    return rivulet::testing::replaced(rows, name, find(name));
}
