// Particles as lit spheres.
#include <rivulet_glad/gl.h>

#include "fluid/render/renderers.h"

namespace rivulet {

namespace {

constexpr ProgramRow kPointsPrograms[] = {
    {"points", "screen_space/points.vert", "screen_space/points.frag"},
    {"points shade", "screen_space/tile.vert", "screen_space/points_shade.frag"},
};

FluidLayers addPoints(gpu::FrameGraph& graph, FluidPrograms& programs, const FluidDraw& d) {
    using gpu::PassContext;
    using gpu::Usage;
    if (d.fluid.count == 0) return {d.colour, {}};
    gpu::TextureDesc size{.width = d.view.width, .height = d.view.height, .format = gpu::Format::rgba8};
    const gpu::TextureHandle surface = graph.texture("points surface", size);
    size.format = gpu::Format::rg16f;
    const gpu::TextureHandle normal = graph.texture("points normal", size);
    std::vector<gpu::Read> reads = {
        {d.frame, Usage::uniform}, {d.position, Usage::sampled}, {d.velocity, Usage::sampled}, {d.id, Usage::sampled}};
    if (d.absorption) reads.emplace_back(d.absorption, Usage::sampled);
    graph.pass("points", reads, {surface, normal, d.depth}, [=, &programs](PassContext& c) {
        const gpu::Framebuffer& target = c.drawTo({surface, normal}, d.depth);
        target.clearColour(vec4(0.0F), 0);
        glBindBufferBase(GL_UNIFORM_BUFFER, 0, c.buffer(d.frame));
        c.state({.depthTest = true});
        gpu::Program& p = programs["points"];
        p.use();
        p.set("radius", d.fluid.radius);
        p.set("colourBy", static_cast<int>(d.look.colourBy));
        p.set("fullSpeed", d.look.fullSpeed);
        p.set("alike", d.fluid.absorption == 0 ? 1 : 0);
        p.set("ownAbsorption", d.look.absorption);
        p.set("dyeDepth", 5.0F * d.fluid.spacing);
        programs.drawParticles(p, d.fluid, {0, d.fluid.count});
    });
    const gpu::TextureHandle tiles = addTiles(graph, programs, d);
    graph.pass("points shade", {{d.frame, Usage::uniform}, surface, normal, d.depth, tiles, d.shadowSharp, d.shadowSoft}, {d.colour},
               [=, &programs](PassContext& c) {
                   c.state({});
                   c.drawTo({d.colour});
                   glBindBufferBase(GL_UNIFORM_BUFFER, 0, c.buffer(d.frame));
                   gpu::Program& p = programs["points shade"];
                   p.use();
                   p.texture("surface", 0, c.texture(surface));
                   p.texture("normal", 1, c.texture(normal));
                   p.texture("depth", 2, c.texture(d.depth));
                   p.texture("shadowSharp", 3, c.texture(d.shadowSharp));
                   p.texture("shadowSoft", 4, c.texture(d.shadowSoft));
                   programs.drawTiles(p, c.texture(tiles), 6);
               });
    return {d.colour, {}};
}

}  // namespace

RendererRow pointsRenderer() {
    return {.name = "points",
            .doc = "every particle as a lit sphere, coloured by speed, density, id, dye, normal or surface",
            .opaque = true,
            .add = addPoints,
            .programs = kPointsPrograms};
}

}  // namespace rivulet
