// Drops in the air, each by itself.
#include "fluid/render/renderers.h"

namespace rivulet {

namespace {

constexpr float kShutter = 1.0F / 250;  // s: what falls fast is drawn out, as on a photograph

}  // namespace

void addDrops(gpu::FrameGraph& graph, FluidPrograms& programs, const FluidDraw& d, const FluidLayers& layers) {
    using gpu::Usage;
    if (d.fluid.dropCount == 0) return;
    const gpu::TextureHandle behind = graph.texture("behind drops", graph.desc(layers.colour));
    copyTexels(graph, "copy scene", layers.colour, behind);
    const gpu::BufferHandle drops = graph.importBuffer("drops", d.fluid.drops, size_t{d.fluid.dropCount} * 2 * sizeof(vec4));
    std::vector<gpu::Read> reads = {{d.frame, Usage::uniform}, {drops, Usage::sampled}, behind, d.depth};
    if (layers.fluidDepth) reads.emplace_back(layers.fluidDepth);
    graph.pass("drops", reads, {layers.colour}, [=, &programs](gpu::PassContext& c) {
        c.drawTo({layers.colour});
        glBindBufferBase(GL_UNIFORM_BUFFER, 0, c.buffer(d.frame));
        glEnable(GL_BLEND);
        glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
        gpu::Program& p = programs[layers.fluidDepth ? "drops over water" : "drops"];
        p.use();
        p.set("shutter", kShutter);
        p.set("refractiveIndex", d.look.refractiveIndex);
        p.texture("sceneColour", 0, c.texture(behind));
        p.texture("sceneDepth", 1, c.texture(d.depth));
        if (layers.fluidDepth) p.texture("waterDepth", 2, c.texture(layers.fluidDepth));
        const QuadRows rows[] = {{d.fluid.drops}};
        programs.drawQuads(p, {0, d.fluid.dropCount}, rows);
    });
}

}  // namespace rivulet
