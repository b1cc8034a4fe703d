#include "fluid/render/renderers.h"

namespace rivulet {

// One a renderer, in the file that draws it.
RendererRow pointsRenderer();
RendererRow screenSpaceRenderer();
RendererRow referenceRenderer();

namespace {
constexpr int kTilePixels = 32;  // pixels
}  // namespace

const Table<RendererRow>& renderers() {
    static const RendererRow rows[] = {pointsRenderer(), screenSpaceRenderer(), referenceRenderer()};
    static const Table<RendererRow> table{rows};
    return table;
}

std::vector<gpu::Read> splatReads(const FluidDraw& d) {
    std::vector<gpu::Read> reads = {{d.frame, gpu::Usage::uniform}, {d.position, gpu::Usage::sampled}};
    if (d.id) reads.emplace_back(d.id, gpu::Usage::sampled);
    for (const gpu::BufferHandle ellipsoids : d.ellipsoids) reads.emplace_back(ellipsoids, gpu::Usage::sampled);
    return reads;
}

// Ids decide which particles represent others.
float detailOf(const FluidDraw& d) { return d.fluid.id != 0 ? d.look.detail : 0.0F; }

void copyTexels(gpu::FrameGraph& graph, const char* name, gpu::TextureHandle from, gpu::TextureHandle to,
                const std::function<void()>& done) {
    graph.pass(name, {{from, gpu::Usage::copy}}, {{to, gpu::Usage::copy}}, [=](gpu::PassContext& c) {
        const gpu::Texture &a = c.texture(from), &b = c.texture(to);
        glCopyImageSubData(a.name(), GL_TEXTURE_2D, 0, 0, 0, 0, b.name(), GL_TEXTURE_2D, 0, 0, 0, 0, a.width(), a.height(), 1);
        if (done) done();
    });
}

gpu::TextureDesc tilesOf(const FrameView& view) {
    return {.width = (view.width + kTilePixels - 1) / kTilePixels,
            .height = (view.height + kTilePixels - 1) / kTilePixels,
            .format = gpu::Format::r8};
}

gpu::TextureHandle addTiles(gpu::FrameGraph& graph, FluidPrograms& programs, const FluidDraw& d) {
    const gpu::TextureDesc size = tilesOf(d.view);
    const gpu::TextureHandle tiles = graph.texture("water tiles", size);
    graph.pass("tiles", splatReads(d), {tiles}, [=, &programs](gpu::PassContext& c) {
        c.drawTo({tiles}).clearColour(vec4(0.0F));
        glBindBufferBase(GL_UNIFORM_BUFFER, 0, c.buffer(d.frame));
        gpu::Program& mark = programs.splat("mark tiles", d.fluid);
        mark.use();
        mark.set("radius", d.fluid.radius);
        mark.set("tiles", vec2(size.width, size.height));
        programs.drawParticles(mark, d.fluid, {0, d.fluid.count});
    });
    return tiles;
}

float volumeScale(const FluidView& fluid) {
    const float ratio = fluid.spacing / fluid.radius;
    return ratio * ratio * ratio / (4.0F / 3.0F * kPi);
}

}  // namespace rivulet
