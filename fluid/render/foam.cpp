// Spray, foam and bubbles as flecks.
#include <rivulet_glad/gl.h>

#include "fluid/render/renderers.h"

namespace rivulet {

void addFoam(gpu::FrameGraph& graph, FluidPrograms& programs, const FluidDraw& d, const FluidLayers& layers, FoamSide side) {
    using gpu::PassContext;
    using gpu::Usage;
    if (d.fluid.foamCount == 0) return;
    std::vector<gpu::Read> reads = {{d.frame, Usage::uniform}, d.depth, d.shadowSharp, d.shadowSoft};
    for (const unsigned name : d.fluid.foam)
        reads.emplace_back(graph.importBuffer("foam", name, d.fluid.foamCount * sizeof(vec4)), Usage::sampled);
    if (layers.fluidDepth) reads.emplace_back(layers.fluidDepth);
    if (side != FoamSide::all) reads.emplace_back(d.glassDepth);
    graph.pass("foam", reads, {layers.colour}, [=, &programs](PassContext& c) {
        c.drawTo({layers.colour});
        glBindBufferBase(GL_UNIFORM_BUFFER, 0, c.buffer(d.frame));
        c.state({.blendSource = GL_SRC_ALPHA, .blendTarget = GL_ONE_MINUS_SRC_ALPHA});
        gpu::Program& p = programs[layers.fluidDepth ? "foam over water" : "foam"];
        p.use();
        p.set("radius", 0.15F * d.fluid.spacing);
        p.set("shutter", d.fluid.exposure);
        p.texture("sceneDepth", 0, c.texture(d.depth));
        p.texture("shadowSharp", 4, c.texture(d.shadowSharp));
        p.texture("shadowSoft", 5, c.texture(d.shadowSoft));
        if (layers.fluidDepth) {
            p.texture("waterDepth", 2, c.texture(layers.fluidDepth));
            p.set("absorption", d.look.absorption);
            p.set("side", static_cast<int>(side));
            if (side != FoamSide::all) p.texture("glassDepth", 3, c.texture(d.glassDepth));
        }
        const QuadRows rows[] = {{d.fluid.foam[0]}, {d.fluid.foam[1]}};
        programs.drawQuads(p, {0, d.fluid.foamCount}, rows);
    });
}

}  // namespace rivulet
