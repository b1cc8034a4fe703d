// Particles as lit spheres.
#include "fluid/render/renderers.h"

namespace rivulet {

FluidLayers addPoints(gpu::FrameGraph& graph, FluidPrograms& programs, const FluidDraw& d) {
    using gpu::Usage;
    if (d.fluid.count == 0) return {d.colour, {}};
    graph.pass("points",
               {{d.frame, Usage::uniform},
                {d.position, Usage::attribute},
                {d.velocity, Usage::attribute},
                {d.id, Usage::attribute},
                d.shadowSharp,
                d.shadowSoft,
                d.waterLight},
               {d.colour, d.depth}, [d, &programs](gpu::PassContext& c) {
                   c.drawTo({d.colour}, d.depth);
                   glBindBufferBase(GL_UNIFORM_BUFFER, 0, c.buffer(d.frame));
                   glEnable(GL_DEPTH_TEST);
                   // The squares inside the spheres first: they hide most of what lies deep in the water before it is shaded.
                   glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
                   programs.occluder.use();
                   programs.occluder.set("radius", d.fluid.radius);
                   programs.drawParticles(d.fluid);
                   glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
                   gpu::Program& p = programs.points;
                   p.use();
                   p.set("radius", d.fluid.radius);
                   p.set("colourBy", static_cast<int>(d.look.colourBy));
                   p.set("fullSpeed", d.look.fullSpeed);
                   p.texture("shadowSharp", 0, c.texture(d.shadowSharp));
                   p.texture("shadowSoft", 1, c.texture(d.shadowSoft));
                   p.texture("waterLight", 2, c.texture(d.waterLight));
                   p.set("waterAbsorption", d.look.absorption);
                   programs.drawParticles(d.fluid);
               });
    return {d.colour, {}};
}

}  // namespace rivulet
