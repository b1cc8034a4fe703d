// The light that the water refracts, as photons.
#include <glm/matrix.hpp>

#include "fluid/render/renderers.h"

namespace rivulet {

namespace {
constexpr float kLeast = 0.75F;     // spacings: less water hardly bends light
constexpr float kMostSize = 20.0F;  // texels, of a photon's picture
}  // namespace

gpu::TextureHandle addCaustics(gpu::FrameGraph& graph, FluidPrograms& programs, const FluidDraw& d, gpu::TextureHandle water,
                               const mat4& projection) {
    gpu::TextureDesc size = graph.desc(water);
    size.format = gpu::Format::rgba16f;
    const gpu::TextureHandle light = graph.texture("caustics", size), flux = graph.texture("photons' flux", size);
    size.format = gpu::Format::rg32f;
    const gpu::TextureHandle landed = graph.texture("photons", size);
    graph.pass("photons", {{d.frame, gpu::Usage::uniform}, water, d.shadowSharp}, {landed, flux}, [=, &programs](gpu::PassContext& c) {
        c.drawTo({landed, flux});
        glBindBufferBase(GL_UNIFORM_BUFFER, 0, c.buffer(d.frame));
        gpu::Program& p = programs["photons"];
        p.use();
        p.texture("water", 0, c.texture(water));
        p.texture("shadowSharp", 1, c.texture(d.shadowSharp));
        p.set("fromLight", glm::inverse(projection));
        p.set("absorption", d.look.absorption + d.look.scattering);
        p.set("refractiveIndex", d.look.refractiveIndex);
        p.set("least", kLeast * d.fluid.spacing);
        c.drawFullscreen();
    });
    graph.pass("caustics", {landed, flux}, {light}, [=, &programs](gpu::PassContext& c) {
        c.drawTo({light}).clearColour(vec4(0.0F));
        glEnable(GL_BLEND);
        glBlendFunc(GL_ONE, GL_ONE);
        gpu::Program& p = programs["caustics"];
        p.use();
        p.texture("landed", 0, c.texture(landed));
        p.texture("flux", 1, c.texture(flux));
        p.set("most", kMostSize);
        programs.none.bind();
        glEnable(GL_PROGRAM_POINT_SIZE);
        glDrawArrays(GL_POINTS, 0, size.width * size.height);
        glDisable(GL_PROGRAM_POINT_SIZE);
    });
    return light;
}

}  // namespace rivulet
