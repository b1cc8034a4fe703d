#include "engine/render/lens.h"

#include <rivulet_glad/gl.h>

#include <algorithm>
#include <vector>

namespace rivulet {
namespace {

using gpu::PassContext;
using gpu::Program;
using gpu::TextureDesc;
using gpu::TextureHandle;
using gpu::Usage;

constexpr float kSensor = 0.024F;   // m, its height: of a full frame
constexpr float kMostBlur = 0.03F;  // of the picture's height, diameter: 48 samples show no gaps up to there
constexpr int kSmallest = 8;        // texels, of the pyramid's last level

// m: the focal length; its square over the aperture's and the sensor's; the focus.
vec3 lensOf(const Lens& lens, const FrameView& view) {
    const float focal = 0.5F * kSensor * view.projection[1][1];
    return {focal, focal * focal / (lens.aperture * kSensor), std::max(lens.focus, 2.0F * focal)};
}

}  // namespace

float blurDiameter(const Lens& lens, const FrameView& view, float depth) {
    if (lens.aperture <= 0) return 0.0F;
    const vec3 made = lensOf(lens, view);
    const float most = made.y / (made.z - made.x);
    return std::clamp(most - most * made.z / depth, -kMostBlur, kMostBlur);
}

Result<LensPrograms> LensPrograms::create(const ShaderFiles& files) {
    LensPrograms p;
    const std::string full = "shaders/render/fullscreen.vert", folder = "shaders/render/";
    std::pair<Program*, Result<Program>> made[] = {
        {&p.bloomDown, Program::create(files, {full, folder + "bloom.frag"}, {{"DOWN", "1"}})},
        {&p.bloomUp, Program::create(files, {full, folder + "bloom.frag"})},
        {&p.blur, Program::create(files, {folder + "depth_of_field.vert", folder + "depth_of_field.frag"})},
    };
    for (auto& [into, program] : made) {
        if (!program) return program.error();
        *into = std::move(*program);
    }
    return p;
}

TextureHandle addDepthOfField(gpu::FrameGraph& graph, LensPrograms& programs, gpu::BufferHandle frame, const FrameView& view,
                              const Lens& lens, TextureHandle colour, TextureHandle depth, TextureHandle fluidDepth) {
    if (lens.aperture <= 0) return colour;
    const TextureHandle blurred = graph.texture("in focus", graph.desc(colour));
    std::vector<gpu::Read> reads = {{frame, Usage::uniform}, colour, depth};
    if (fluidDepth) reads.emplace_back(fluidDepth);
    graph.pass("depth of field", reads, {blurred}, [=, &programs](PassContext& c) {
        c.drawTo({blurred});
        glBindBufferBase(GL_UNIFORM_BUFFER, 0, c.buffer(frame));
        Program& p = programs.blur;
        p.use();
        p.texture("sceneColour", 0, c.texture(colour));
        p.texture("sceneDepth", 1, c.texture(depth));
        p.set("water", fluidDepth ? 1 : 0);
        if (fluidDepth) p.texture("fluidDepth", 2, c.texture(fluidDepth));
        const vec3 made = lensOf(lens, view);
        const float radius = 0.5F * static_cast<float>(view.height);
        p.set("automatic", lens.automatic ? 1 : 0);
        p.set("lens", vec4(made.x, radius * made.y, made.z, radius * kMostBlur));
        c.drawFullscreen();
    });
    return blurred;
}

TextureHandle addBloom(gpu::FrameGraph& graph, LensPrograms& programs, const Lens& lens, TextureHandle colour) {
    if (lens.bloom <= 0) return colour;
    TextureDesc size = graph.desc(colour);
    std::vector<TextureHandle> levels = {colour};
    while (std::min(size.width, size.height) >= 2 * kSmallest) {
        size.width = (size.width + 1) / 2;
        size.height = (size.height + 1) / 2;
        const TextureHandle from = levels.back(), to = graph.texture("bloom", size);
        graph.pass("bloom", {from}, {to}, [=, &programs](PassContext& c) {
            c.drawTo({to});
            programs.bloomDown.use();
            programs.bloomDown.texture("source", 0, c.texture(from));
            c.drawFullscreen();
        });
        levels.push_back(to);
    }
    TextureHandle wide = levels.back();
    for (size_t k = levels.size() - 1; k-- > 0;) {  // half of each level and half of all wider ones; of the picture what the lens leaves
        const TextureHandle from = wide, sharp = levels[k], to = graph.texture("bloom", graph.desc(sharp));
        const float share = k == 0 ? lens.bloom : 0.5F;
        graph.pass("bloom", {from, sharp}, {to}, [=, &programs](PassContext& c) {
            c.drawTo({to});
            programs.bloomUp.use();
            programs.bloomUp.texture("source", 0, c.texture(from));
            programs.bloomUp.texture("sharp", 1, c.texture(sharp));
            programs.bloomUp.set("share", share);
            c.drawFullscreen();
        });
        wide = to;
    }
    return wide;
}

}  // namespace rivulet
