// What each drawing pass of a picture does: invocations of its vertex and fragment shaders and their reads of textures, which the shaders
// count themselves, bytes (gpu::trafficOf), and the shaders' texts. A shader that counts cannot be left out by an early depth test:
// fragments that are hidden count too.
//
//     gpu_cost_passes SPACING FRAMES FOLDER
//
// Draws dam_break, pbf, after FRAMES frames on the cpu, at 1920x1080. Writes FOLDER/passes.csv and FOLDER/PASS.vert, PASS.frag.
#include <EGL/egl.h>
#include <fmt/format.h>
#include <rivulet_glad/gl.h>

#include <cstdlib>
#include <cstring>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "engine/app/context_egl.h"
#include "engine/core/file.h"
#include "engine/gpu/load.h"
#include "fluid/render/backend.h"
#include "fluid/render/fluid_upload.h"
#include "fluid/session/scene_renderer.h"
#include "fluid/session/session.h"

namespace rivulet {
namespace {

constexpr int kCounts = 6;
constexpr GLuint kReadsBinding = 7;  // no drawing shader has a buffer there
// Put after the first line of a shader: functions of the same names that count. A macro is not replaced inside itself.
// counts: reads of vertex and fragment shaders, then invocations, then fetches of texels among the reads.
constexpr const char* kCountReads = R"(
layout(std430, binding = 7) buffer Counted { uint counted_[]; };
#define COUNTED_(T, F, A, B) T F##_counted A { atomicAdd(counted_[COUNTED_STAGE], 1u); return F B; }
#define FETCHED_(T, A, B) T texelFetch_counted A { atomicAdd(counted_[COUNTED_STAGE], 1u); atomicAdd(counted_[COUNTED_STAGE + 4], 1u); return texelFetch B; }
COUNTED_(vec4, texture, (sampler2D s, vec2 p), (s, p))
COUNTED_(vec4, texture, (samplerCube s, vec3 p), (s, p))
COUNTED_(vec4, textureLod, (sampler2D s, vec2 p, float l), (s, p, l))
COUNTED_(vec4, textureLod, (samplerCube s, vec3 p, float l), (s, p, l))
FETCHED_(vec4, (sampler2D s, ivec2 p, int l), (s, p, l))
FETCHED_(vec4, (samplerBuffer s, int p), (s, p))
FETCHED_(uvec4, (usamplerBuffer s, int p), (s, p))
#define texture texture_counted
#define textureLod textureLod_counted
#define texelFetch texelFetch_counted
#define main main_counted
)";
constexpr const char* kCountInvocations = R"(
#undef main
void main() { atomicAdd(counted_[COUNTED_STAGE + 2], 1u); main_counted(); }
)";

struct Work {
    double vertices = 0, fragments = 0, vertexReads = 0, fragmentReads = 0, vertexFetches = 0, fragmentFetches = 0;
    std::string vertex, fragment;  // texts of its last program
};
struct Counting {
    std::map<std::string, Work> passes;
    std::string pass;
    std::map<GLuint, std::pair<GLenum, std::string>> shaders;
    std::map<GLuint, std::vector<GLuint>> programs;
    GLuint program = 0, buffer = 0;
} counting;

void (*realSource)(GLuint, GLsizei, const GLchar* const*, const GLint*);
void (*realAttach)(GLuint, GLuint);
void (*realUse)(GLuint);
void (*realPush)(GLenum, GLuint, GLsizei, const GLchar*);
void (*realPop)();
GLuint (*realCreate)(GLenum);

GLuint createShader(GLenum type) {
    const GLuint shader = realCreate(type);
    counting.shaders[shader].first = type;
    return shader;
}
void shaderSource(GLuint shader, GLsizei count, const GLchar* const* texts, const GLint* lengths) {
    std::string text;
    for (GLsizei k = 0; k < count; ++k)
        text += lengths != nullptr && lengths[k] >= 0 ? std::string(texts[k], static_cast<size_t>(lengths[k])) : texts[k];
    const GLenum type = counting.shaders[shader].first;
    counting.shaders[shader].second = text;
    if (type == GL_VERTEX_SHADER || type == GL_FRAGMENT_SHADER) {
        text.insert(text.find('\n') + 1, std::string("#define COUNTED_STAGE ") + (type == GL_VERTEX_SHADER ? "0" : "1") + kCountReads);
        text += kCountInvocations;
    }
    const GLchar* one = text.c_str();
    realSource(shader, 1, &one, nullptr);
}
void attachShader(GLuint program, GLuint shader) {
    counting.programs[program].push_back(shader);
    realAttach(program, shader);
}
void useProgram(GLuint program) {
    if (program != 0) counting.program = program;
    realUse(program);
}
void pushGroup(GLenum source, GLuint id, GLsizei length, const GLchar* message) {
    realPush(source, id, length, message);
    counting.pass.assign(message, length < 0 ? std::strlen(message) : static_cast<size_t>(length));
    counting.program = 0;
    const GLuint zeros[kCounts] = {};
    glNamedBufferSubData(counting.buffer, 0, sizeof zeros, zeros);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, kReadsBinding, counting.buffer);
}
void popGroup() {
    glMemoryBarrier(GL_ALL_BARRIER_BITS);
    glFinish();
    GLuint counts[kCounts] = {};
    glGetNamedBufferSubData(counting.buffer, 0, sizeof counts, counts);
    Work& work = counting.passes[counting.pass];
    work.vertexReads += counts[0];
    work.fragmentReads += counts[1];
    work.vertices += counts[2];
    work.fragments += counts[3];
    work.vertexFetches += counts[4];
    work.fragmentFetches += counts[5];
    for (const GLuint shader : counting.programs[counting.program]) {
        const auto& [type, text] = counting.shaders[shader];
        (type == GL_VERTEX_SHADER ? work.vertex : work.fragment) = text;
    }
    realPop();
}

template <class F>
gpu::FunctionPointer wrapped(F*& real, F* mine, gpu::FunctionPointer found) {
    real = reinterpret_cast<F*>(found);
    return reinterpret_cast<gpu::FunctionPointer>(mine);
}
gpu::FunctionPointer findCounting(const char* name) {
    const gpu::FunctionPointer found = eglGetProcAddress(name);
    const std::string_view n = name;
    if (n == "glCreateShader") return wrapped(realCreate, createShader, found);
    if (n == "glShaderSource") return wrapped(realSource, shaderSource, found);
    if (n == "glAttachShader") return wrapped(realAttach, attachShader, found);
    if (n == "glUseProgram") return wrapped(realUse, useProgram, found);
    if (n == "glPushDebugGroup") return wrapped(realPush, pushGroup, found);
    if (n == "glPopDebugGroup") return wrapped(realPop, popGroup, found);
    return found;
}

Status run(float spacing, int frames, const std::string& folder) {
    const Result<ContextEgl> egl = ContextEgl::create();
    if (!egl) return egl.error();
    Result<SceneFile> scene = loadScene("dam_break.json", {});
    if (!scene) return scene.error();
    scene->fluid.method = "pbf";
    scene->fluid.spacing = spacing;
    scene->look.quality = "fine";
    const std::unique_ptr<Device> cpu = makeCpu();
    Result<std::unique_ptr<Session>> session = Session::create(*scene, *cpu, {});
    if (!session) return session.error();
    for (int k = 0; k < frames; ++k) {
        (*session)->step(1.0 / kFramesPerSecond, true);
        if (Status stepped = (*session)->world().lastStep(); !stepped) return stepped;
    }
    if (Status loaded = gpu::load(findCounting); !loaded) return loaded;
    glEnable(GL_DEBUG_OUTPUT);  // passes are named for a debugger that listens
    glCreateBuffers(1, &counting.buffer);
    glNamedBufferStorage(counting.buffer, kCounts * sizeof(GLuint), nullptr, GL_DYNAMIC_STORAGE_BIT);
    const FrameView view = frameViewOf(cameraOf(scene->camera, (*session)->bounds()), scene->light, 1920, 1080, 0);
    Result<std::unique_ptr<SceneRenderer>> renderer = SceneRenderer::create(ShaderFiles::developer());
    if (!renderer) return renderer.error();
    (*renderer)->describe(true);
    FluidUpload upload;
    const Result<FluidView> fluid = upload.view((*session)->world(), scene->look);
    if (!fluid) return fluid.error();
    for (int k = 0; k < 2; ++k) {  // maps of shadows and the sky are made by the first picture alone
        counting.passes.clear();
        if (Status drawn = (*renderer)->draw(view, *fluid, (*session)->solids(), *scene); !drawn) return drawn;
    }
    std::vector<gpu::PassTraffic> traffic;
    if ((*renderer)->description()) traffic = gpu::trafficOf(*(*renderer)->description());
    std::string csv = "pass,passes,read_bytes,written_bytes,vertices,fragments,vertex_reads,reads,vertex_fetches,fetches\n";
    for (const gpu::PassTraffic& pass : traffic) {
        const Work& work = counting.passes[pass.name];
        csv += fmt::format("{},{},{},{},{:.0f},{:.0f},{:.0f},{:.0f},{:.0f},{:.0f}\n", pass.name, pass.passes, pass.read, pass.written,
                           work.vertices, work.fragments, work.vertexReads, work.fragmentReads, work.vertexFetches, work.fragmentFetches);
        for (const auto& [ending, text] : {std::pair("vert", &work.vertex), std::pair("frag", &work.fragment)})
            if (!text->empty())
                if (Status written = writeFileAtomic(fmt::format("{}/{}.{}", folder, pass.name, ending), *text); !written) return written;
    }
    fmt::print("{} particles\n", (*session)->world().particles().count);
    if (Status written = writeFileAtomic(folder + "/passes.csv", csv); !written) return written;
    return gpu::load(eglGetProcAddress);
}

}  // namespace
}  // namespace rivulet

int main(int argc, char** argv) {
    if (argc != 4) {
        fmt::print(stderr, "usage: gpu_cost_passes SPACING FRAMES FOLDER\n");
        return 2;
    }
    const rivulet::Status done = rivulet::run(std::strtof(argv[1], nullptr), std::atoi(argv[2]), argv[3]);
    if (!done) fmt::print(stderr, "{}\n", done.error().message);
    return done ? 0 : 1;
}
