// test_gpus: the shaders that scenes use, for run.sh. A variant is a shader and its defines, one a line: a kernel as
// Device::kernels() writes it ("fluid/methods/integrate;OPEN=1"), or a drawing program, "render/box.vert+render/box.frag;OVER_WATER=1".
//
//     test_gpus variants SCENE...        the variants of these scenes and their presets, run on OpenGL for two frames; of a host's water
//     test_gpus rest VARIANTS            variants of each kernel that the list lacks, of those that GPUs run
//     test_gpus texts VARIANTS FOLDER    writes FOLDER/NUMBER.comp and .cl of a kernel, .vert and .frag of a program; FOLDER/index.txt
//     test_gpus check VARIANTS SCENE...  fails if the list lacks a shader file, or a kernel that a scene uses on the cpu
#include <fmt/format.h>
#include <rivulet_glad/gl.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "engine/app/context_egl.h"
#include "engine/compute/device_cpu.h"
#include "engine/compute/kernel_source.h"
#include "fluid/render/backend.h"
#include "fluid/render/fluid_upload.h"
#include "fluid/render/host_surroundings.h"
#include "fluid/render/water_renderer.h"
#include "fluid/session/replay.h"
#include "fluid/session/scene_renderer.h"
#include "fluid/session/session.h"
#include "fluid/sim/world/cpu_kernels.h"

namespace rivulet {
namespace {

namespace fs = std::filesystem;
using Names = std::set<std::string>;

constexpr const char* kGlsl = "#version 450 core\n";
constexpr int kFailed = 1;

// Kernels that are asked for on the cpu alone: a GPU has others in their place.
bool forCpuOnly(std::string_view path) { return path.starts_with("fluid/grid/cpu_") || path == "flow/map_tiles"; }

struct Variant {
    std::vector<std::string> shaders;  // one kernel, or a vertex and a fragment shader
    std::vector<Define> defines;
    bool draws() const { return shaders.size() > 1; }
};

Variant variantOf(std::string_view line) {
    Variant v;
    size_t at = 0;
    for (bool first = true; at <= line.size(); first = false) {
        const size_t end = std::min(line.find(';', at), line.size());
        const std::string_view part = line.substr(at, end - at);
        const size_t plus = part.find('+'), equals = part.find('=');
        if (first && plus != std::string_view::npos)
            v.shaders = {std::string(part.substr(0, plus)), std::string(part.substr(plus + 1))};
        else if (first)
            v.shaders = {std::string(part)};
        else
            v.defines.push_back({std::string(part.substr(0, equals)), std::string(part.substr(std::min(equals + 1, part.size())))});
        at = end + 1;
    }
    return v;
}

std::string lineOf(const std::string& shaders, std::vector<Define> defines) {
    std::sort(defines.begin(), defines.end(), [](const Define& a, const Define& b) { return a.name < b.name; });
    std::string line = shaders;
    for (const Define& d : defines) line += fmt::format(";{}={}", d.name, d.value);
    return line;
}

std::vector<std::string> linesOf(const std::string& path) {
    std::ifstream file(path);
    std::vector<std::string> lines;
    for (std::string line; std::getline(file, line);)
        if (!line.empty()) lines.push_back(line);
    return lines;
}

// The files under shaders/ with this ending, as a variant names them.
Names shaderFiles(const std::string& ending) {
    Names found;
    const fs::path root = fs::path(RIVULET_SOURCE_DIR) / "shaders";
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root)) {
        fs::path name = fs::relative(entry.path(), root);
        if (name.extension() != ending) continue;
        if (ending == ".kernel") name.replace_extension();
        found.insert(name.generic_string());
    }
    return found;
}

// Records the text of each shader that OpenGL is given, and which of them become one program.
struct Recorder {
    std::map<GLuint, std::string> texts;
    std::map<GLuint, std::vector<GLuint>> programs;
    std::set<std::pair<std::string, std::string>> drawn;  // texts of vertex and fragment shaders
};
Recorder recorder;
PFNGLSHADERSOURCEPROC shaderSource;
PFNGLATTACHSHADERPROC attachShader;
PFNGLLINKPROGRAMPROC linkProgram;

void recordSource(GLuint shader, GLsizei count, const GLchar* const* text, const GLint* length) {
    recorder.texts[shader] = std::string(text[0], static_cast<size_t>(length[0]));
    shaderSource(shader, count, text, length);
}
void recordAttached(GLuint program, GLuint shader) {
    recorder.programs[program].push_back(shader);
    attachShader(program, shader);
}
void recordLinked(GLuint program) {
    const std::vector<GLuint> parts = std::exchange(recorder.programs[program], {});
    if (parts.size() == 2) recorder.drawn.emplace(recorder.texts[parts[0]], recorder.texts[parts[1]]);
    linkProgram(program);
}
void record() {
    shaderSource = std::exchange(glShaderSource, recordSource);
    attachShader = std::exchange(glAttachShader, recordAttached);
    linkProgram = std::exchange(glLinkProgram, recordLinked);
}

// The defines at the head of a text.
std::vector<Define> definesOf(std::string_view text) {
    std::vector<Define> defines;
    text.remove_prefix(std::string_view(kGlsl).size());
    while (text.starts_with("#define ")) {
        const size_t name = std::string_view("#define ").size(), space = text.find(' ', name), end = text.find('\n');
        defines.push_back({std::string(text.substr(name, space - name)), std::string(text.substr(space + 1, end - space - 1))});
        text.remove_prefix(end + 1);
    }
    return defines;
}

// Finds the shader file that gives this text with these defines. An empty name: none does.
std::string fileOf(const ShaderFiles& files, const Names& among, const std::string& text, const std::vector<Define>& defines) {
    for (const std::string& name : among) {
        const Result<KernelSource> source = files.flatten("shaders/" + name, defines, Dialect::glsl, kGlsl);
        if (source && source->text == text) return name;
    }
    return "";
}

Names drawnVariants() {
    const ShaderFiles files = ShaderFiles::developer();
    const Names vertex = shaderFiles(".vert"), fragment = shaderFiles(".frag");
    Names lines;
    for (const auto& [vert, frag] : recorder.drawn) {
        const std::vector<Define> defines = definesOf(vert);
        lines.insert(lineOf(fileOf(files, vertex, vert, defines) + "+" + fileOf(files, fragment, frag, defines), defines));
    }
    return lines;
}

struct Running {
    SceneFile scene;
    std::unique_ptr<Session> session;
};
// With particles twice as far apart if the scene allows it: the kernels are the same, and it opens sooner.
Result<Running> opened(const std::string& path, const std::string& preset, Device& device) {
    const Result<SceneFile> fine = loadScene(path, {}, preset);
    if (!fine) return fine.error();
    const std::vector<std::string> coarser = {fmt::format("fluid.spacing={}", 2 * fine->fluid.spacing)};
    if (Result<SceneFile> coarse = loadScene(path, coarser, preset))
        if (auto session = Session::create(*coarse, device, {})) return Running{std::move(*coarse), std::move(*session)};
    auto session = Session::create(*fine, device, {});
    if (!session) return session.error();
    return Running{*fine, std::move(*session)};
}

Status runOnGl(const std::string& scenePath, const std::string& preset, Names& used) {
    const std::unique_ptr<Device> device = makeDevice("gl", currentGlFacts(), {});
    Result<Running> running = opened(scenePath, preset, *device);
    if (!running) return running.error();
    const SceneFile& scene = running->scene;
    Session& session = *running->session;
    const auto surroundings = surroundingsOf(scene);
    if (!surroundings) return surroundings.error();
    auto renderer = SceneRenderer::create(ShaderFiles::developer(), *surroundings ? &**surroundings : nullptr);
    if (!renderer) return renderer.error();
    FluidUpload upload;
    for (const bool hurried : {true, false}) {
        session.step(frameSeconds(scene), true);
        Result<FluidView> fluid = viewOf(upload, session);
        if (!fluid) return fluid.error();
        if (Status wet = session.flows().draw(); !wet) return wet;
        (*renderer)->hurry(hurried);
        const FrameView view = frameViewOf(cameraOf(scene.camera, session.bounds()), scene.light, 64, 36, session.time());
        if (Status drawn = (*renderer)->draw(view, *fluid, session.solids(), session.scene()); !drawn) return drawn;
    }
    for (const std::string& kernel : device->kernels()) used.insert(kernel);
    return ok();
}

int listVariants(std::span<const std::string> scenes) {
    Result<ContextEgl> context = ContextEgl::create();
    if (!context) {
        fmt::print(stderr, "{}\n", context.error().message);
        return kFailed;
    }
    record();
    Names used;
    for (const std::string& path : scenes) {
        std::vector<std::string> presets = {""};
        if (const Result<SceneFile> scene = loadScene(path, {}))
            for (const PresetParams& preset : scene->presets) presets.push_back(preset.name);
        for (const std::string& preset : presets) {
            fmt::print(stderr, "{} {}\n", path, preset);
            if (Status ran = runOnGl(path, preset, used); !ran)  // a mesh is missing that is not part of the repository
                fmt::print(stderr, "left out: {}\n", ran.error().message);
        }
    }
    for (const std::string& line : drawnVariants()) used.insert(line);
    // Of a host's water those that no scene has: what they add to the others is the same for all.
    if (const auto water = WaterRenderer::create({}); !water) {
        fmt::print(stderr, "{}\n", water.error().message);
        return kFailed;
    }
    if (const auto surroundings = SurroundingsMap::create(ShaderFiles::developer()); !surroundings) {
        fmt::print(stderr, "{}\n", surroundings.error().message);
        return kFailed;
    }
    Names fragments;
    for (const std::string& line : used)
        if (const Variant v = variantOf(line); v.draws()) fragments.insert(v.shaders[1]);
    for (const std::string& line : drawnVariants())
        if (!fragments.contains(variantOf(line).shaders[1])) used.insert(line);
    for (const std::string& line : used) fmt::print("{}\n", line);
    return 0;
}

Names kernelsIn(std::span<const std::string> lines) {
    Names named;
    for (const std::string& line : lines)
        for (const std::string& shader : variantOf(line).shaders) named.insert(shader);
    return named;
}

int listRest(const std::string& list) {
    const Names named = kernelsIn(linesOf(list));
    Names rest;
    for (const CpuKernelRow& row : cpuKernels())
        if (!named.contains(row.path) && !forCpuOnly(row.path))
            rest.insert(*row.defines == '\0' ? row.path : fmt::format("{};{}", row.path, row.defines));
    Names compiled;
    for (const CpuKernelRow& row : cpuKernels()) compiled.insert(row.path);
    for (const std::string& path : shaderFiles(".kernel"))
        if (!named.contains(path) && !compiled.contains(path) && path != "bench/rate_math") rest.insert(path);
    if (!named.contains("bench/rate_math"))  // as fluid/validate/gpu_rates.cpp asks for it
        for (int kind = 0; kind < 5; ++kind)
            for (int operations = 1; operations <= 2; ++operations)
                rest.insert(fmt::format("bench/rate_math;KIND={};OPERATIONS={}", kind, operations));
    for (const std::string& line : rest) fmt::print("{}\n", line);
    return 0;
}

int writeTexts(const std::string& list, const std::string& folder) {
    const ShaderFiles files = ShaderFiles::developer();
    std::ofstream index(folder + "/index.txt");
    size_t number = 0;
    for (const std::string& line : linesOf(list)) {
        Variant variant = variantOf(line);
        const std::string name = fmt::format("{}/{:04}", folder, ++number);
        index << fmt::format("{:04}\t{}", number, line);
        if (!variant.draws() && std::ranges::none_of(variant.defines, [](const Define& d) { return d.name == "LOCAL_SIZE"; }))
            variant.defines.push_back({"LOCAL_SIZE", "64"});
        struct Text {
            std::string file, ending;
            Dialect dialect;
        };
        std::vector<Text> texts;
        for (const std::string& shader : variant.shaders)
            if (variant.draws())
                texts.push_back({"shaders/" + shader, fs::path(shader).extension().string(), Dialect::glsl});
            else
                texts.insert(texts.end(), {{fmt::format("shaders/{}.kernel", shader), ".comp", Dialect::glsl},
                                           {fmt::format("shaders/{}.kernel", shader), ".cl", Dialect::openclC}});
        for (const Text& text : texts) {
            const bool glsl = text.dialect == Dialect::glsl;
            const Result<KernelSource> source = files.flatten(text.file, variant.defines, text.dialect, glsl ? kGlsl : "");
            if (!source) {
                fmt::print(stderr, "{}: {}\n", line, source.error().message);
                return kFailed;
            }
            std::ofstream(name + text.ending) << source->text;
            if (glsl) index << '\t' << fmt::format("{}", fmt::join(source->files, " "));  // "ERROR: 2:17:" is line 17 of the third of them
        }
        index << '\n';
    }
    return 0;
}

std::string withoutGroup(const std::string& line) {
    Variant v = variantOf(line);
    std::erase_if(v.defines, [](const Define& d) { return d.name == "LOCAL_SIZE"; });
    return lineOf(v.shaders.front(), v.defines);
}

int check(const std::string& list, std::span<const std::string> scenes) {
    const std::vector<std::string> lines = linesOf(list);
    const Names named = kernelsIn(lines);
    Names missing, known;
    for (const char* ending : {".kernel", ".vert", ".frag"})
        for (const std::string& file : shaderFiles(ending))
            if (!named.contains(file) && !forCpuOnly(file)) missing.insert(file);
    for (const std::string& line : lines)
        if (!variantOf(line).draws()) known.insert(withoutGroup(line));
    for (const std::string& path : scenes) {
        const std::unique_ptr<Device> device = makeCpu();
        const Result<Running> running = opened(path, "", *device);
        if (!running) {
            fmt::print("left out: {}\n", running.error().message);
            continue;
        }
        for (const std::string& kernel : device->kernels())
            if (!forCpuOnly(kernel.substr(0, kernel.find(';'))) && !known.contains(kernel)) missing.insert(kernel);
    }
    for (const std::string& line : missing)
        fmt::print("{} is not in {}; make the list again: bash tests/gpus/run.sh variants\n", line, list);
    return missing.empty() ? 0 : kFailed;
}

}  // namespace
}  // namespace rivulet

int main(int argc, char** argv) {
    using namespace rivulet;
    const std::vector<std::string> words(argv + 1, argv + argc);
    const std::span<const std::string> all(words);
    const std::string verb = words.empty() ? "" : words[0];
    if (verb == "variants") return listVariants(all.subspan(1));
    if (verb == "rest" && words.size() == 2) return listRest(words[1]);
    if (verb == "texts" && words.size() == 3) return writeTexts(words[1], words[2]);
    if (verb == "check" && words.size() >= 2) return check(words[1], all.subspan(2));
    fmt::print(stderr, "test_gpus variants SCENE... | rest VARIANTS | texts VARIANTS FOLDER | check VARIANTS SCENE...\n");
    return 2;
}
