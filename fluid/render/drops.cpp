// Drops in the air and drops that hang, each by itself.
#include <rivulet_glad/gl.h>

#include "fluid/render/renderers.h"

namespace rivulet {

namespace {

constexpr float kShutter = 1.0F / 250;  // s: what falls fast is drawn out, as on a photograph

}  // namespace

gpu::TextureHandle addDrops(gpu::FrameGraph& graph, FluidPrograms& programs, const FluidDraw& d, const FluidLayers& layers) {
    using gpu::Usage;
    const FluidView fluid = d.fluid;
    if (fluid.dropCount == 0 && fluid.pendantCount == 0) return d.depth;
    const gpu::TextureHandle behind = graph.texture("behind drops", graph.desc(layers.colour));
    copyTexels(graph, "copy scene", layers.colour, behind);
    const gpu::TextureHandle depth = graph.texture("depth with drops", graph.desc(d.depth));
    copyTexels(graph, "copy scene depth", d.depth, depth);
    std::vector<gpu::Read> reads = {{d.frame, Usage::uniform}, behind, d.depth};
    if (fluid.dropCount > 0)
        reads.push_back({graph.importBuffer("drops", fluid.drops, size_t{fluid.dropCount} * 2 * sizeof(vec4)), Usage::sampled});
    if (fluid.pendantCount > 0)
        reads.push_back({graph.importBuffer("pendants", fluid.pendants, size_t{fluid.pendantCount} * 5 * sizeof(vec4)), Usage::sampled});
    if (layers.fluidDepth) reads.emplace_back(layers.fluidDepth);
    graph.pass("drops", reads, {layers.colour, depth}, [=, &programs](gpu::PassContext& c) {
        c.drawTo({layers.colour}, depth);
        glBindBufferBase(GL_UNIFORM_BUFFER, 0, c.buffer(d.frame));
        // The shaders compare depths.
        c.state({.depthTest = true, .depthFunction = GL_ALWAYS, .blendSource = GL_SRC_ALPHA, .blendTarget = GL_ONE_MINUS_SRC_ALPHA});
        const auto draw = [&](const char* alone, const char* overWater, unsigned buffer, uint32_t count) {
            if (count == 0) return;
            gpu::Program& p = programs[layers.fluidDepth ? overWater : alone];
            p.use();
            if (buffer == fluid.drops) p.set("shutter", kShutter);
            p.set("refractiveIndex", d.look.refractiveIndex);
            p.texture("sceneColour", 0, c.texture(behind));
            p.texture("sceneDepth", 1, c.texture(d.depth));
            if (layers.fluidDepth) p.texture("waterDepth", 2, c.texture(layers.fluidDepth));
            const QuadRows rows[] = {{buffer}};
            programs.drawQuads(p, {0, count}, rows);
        };
        draw("drops", "drops over water", fluid.drops, fluid.dropCount);
        draw("pendants", "pendants over water", fluid.pendants, fluid.pendantCount);
    });
    return depth;
}

}  // namespace rivulet
