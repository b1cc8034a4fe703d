// The droplets of what has left the body of the water.
#include <rivulet_glad/gl.h>

#include <algorithm>

#include "fluid/render/renderers.h"

namespace rivulet {

namespace {
// m: particles of this spacing and less are drops, which tension holds together; of the other and more, spray of finer drops (the capillary
// length of water is 2.7 mm, and drops of 5 mm break in the air: Villermaux and Bossa 2009).
constexpr float kDrops = 0.002F, kSpray = 0.008F;
// Half the longest path during the exposure that is drawn, of the picture's height; where droplets are points, it may be shorter.
constexpr float kLongestPath = 0.1F;
constexpr float kPathsEach = 4.0F;  // of those lengths in a droplet's picture: 2.4, and longer away from the picture's axis
}  // namespace

void addSpray(gpu::FrameGraph& graph, FluidPrograms& programs, const FluidDraw& d, const FluidLayers& layers) {
    using gpu::Usage;
    const RowRange rows{0, d.fluid.asleep == 0 ? d.fluid.count : d.fluid.awake};  // what sleeps is part of the body
    if (rows.count == 0) return;
    const bool ink = d.fluid.absorption != 0;
    // With these, FluidView::velocity holds normals.
    const bool moves = d.velocity && d.fluid.velocity != 0 && d.look.colourBy != ColourBy::normal && d.look.colourBy != ColourBy::surface;
    const gpu::TextureHandle behind = graph.texture("behind spray", graph.desc(layers.colour));
    copyTexels(graph, "copy scene", layers.colour, behind);
    std::vector<gpu::Read> reads = splatReads(d);
    for (const gpu::TextureHandle texture : {behind, d.depth, layers.fluidDepth, d.shadowSharp, d.shadowSoft}) reads.emplace_back(texture);
    if (moves) reads.emplace_back(d.velocity, Usage::sampled);
    if (ink) reads.emplace_back(d.absorption, Usage::sampled);
    graph.pass("spray", reads, {layers.colour}, [=, &programs](gpu::PassContext& c) {
        c.drawTo({layers.colour});
        glBindBufferBase(GL_UNIFORM_BUFFER, 0, c.buffer(d.frame));
        c.state({.blendSource = GL_SRC_ALPHA, .blendTarget = GL_ONE_MINUS_SRC_ALPHA});
        gpu::Program& p = programs[ink ? "spray, ink" : "spray"];
        p.use();
        p.set("radius", d.fluid.radius);
        p.set("detail", detailOf(d));
        p.set("spacing", d.fluid.spacing);
        p.set("named", d.fluid.id != 0 ? 1 : 0);
        p.set("split", glm::smoothstep(kDrops, kSpray, d.fluid.spacing));
        p.set("shutter", moves ? d.fluid.exposure : 0.0F);
        p.set("refractiveIndex", d.look.refractiveIndex);
        p.set("ownAbsorption", vec4(d.look.absorption, d.look.scattering.y));
        p.texture("sceneColour", 0, c.texture(behind));
        p.texture("sceneDepth", 1, c.texture(d.depth));
        p.texture("waterDepth", 2, c.texture(layers.fluidDepth));
        p.texture("shadowSharp", 4, c.texture(d.shadowSharp));
        p.texture("shadowSoft", 5, c.texture(d.shadowSoft));
        // Droplets reach 1.72 spacings from their particle, and half their path on.
        Splats splats = splatsOf(d, std::max(d.fluid.radius, 0.5F * d.fluid.spacing), 1);
        float longest = moves ? kLongestPath * splats.target.y : 0.0F;
        if (splats.largest < programs.largestPoint) longest = std::min(longest, (programs.largestPoint - splats.largest) / kPathsEach);
        p.set("longest", longest);
        splats.largest += kPathsEach * longest;
        programs.drawSplats(p, d.fluid, splats, rows);
    });
}

}  // namespace rivulet
