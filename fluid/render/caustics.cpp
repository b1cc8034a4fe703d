// The light that the water refracts, as photons.
#include <rivulet_glad/gl.h>
#include <algorithm>
#include <array>
#include <glm/matrix.hpp>

#include "fluid/render/kept_pictures.h"
#include "fluid/render/renderers.h"

namespace rivulet {

namespace {
constexpr float kLeast = 0.75F;     // spacings: less water hardly bends light
constexpr float kMostSize = 20.0F;  // texels, of a photon's picture

// What is kept while all sleep and the shadows stand; null: nothing.
std::shared_ptr<KeptPicture> keptOf(FluidPrograms& programs, const FluidDraw& d, const mat4& projection, const gpu::TextureDesc& size) {
    const FluidView& f = d.fluid;
    if (!f.sleepers || f.asleep == 0 || f.awake > 0) return nullptr;
    KeptPictures::Key key{f.sleepers, nullptr, {static_cast<float>(size.width), f.radius, f.spacing, d.look.refractiveIndex}};
    key.values.insert(key.values.end(), d.receivers.begin(), d.receivers.end());
    const vec3 absorption = d.look.absorption + d.look.scattering;
    key.values.insert(key.values.end(), {absorption.r, absorption.g, absorption.b, static_cast<float>(d.shadowVersion)});
    for (int k = 0; k < 16; ++k) key.values.push_back(projection[k / 4][k % 4]);
    return programs.kept.find(key, std::array{KeptPictures::Wanted(KeptPicture::caustics, size)});
}

}  // namespace

gpu::TextureHandle addCaustics(gpu::FrameGraph& graph, FluidPrograms& programs, const FluidDraw& d, gpu::TextureHandle water,
                               const mat4& projection) {
    gpu::TextureDesc size = graph.desc(water);
    size.format = gpu::Format::rgba16f;
    const std::shared_ptr<KeptPicture> kept = keptOf(programs, d, projection, size);
    const gpu::TextureHandle light =
        kept ? graph.importTexture("caustics", kept->textures[KeptPicture::caustics]) : graph.texture("caustics", size);
    if (kept && kept->drawn[KeptPicture::caustics]) return light;
    const gpu::TextureHandle flux = graph.texture("photons' flux", size);
    size.format = gpu::Format::rg32f;
    const gpu::TextureHandle landed = graph.texture("photons", size);
    graph.pass("photons", {{d.frame, gpu::Usage::uniform}, water, d.shadowSharp}, {landed, flux}, [=, &programs](gpu::PassContext& c) {
        c.state({});
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
        c.state({});
        c.drawTo({light});
        gpu::Program& dry = programs["caustics, dry"];
        dry.use();
        dry.texture("flux", 1, c.texture(flux));
        c.drawFullscreen();
        c.state({.blendTarget = GL_ONE});
        gpu::Program& p = programs["caustics"];
        p.use();
        p.texture("landed", 0, c.texture(landed));
        p.texture("flux", 1, c.texture(flux));
        p.set("most", std::min(kMostSize, programs.largestPoint - 1.0F));
        programs.none.bind();
        glEnable(GL_PROGRAM_POINT_SIZE);
        glDrawArrays(GL_POINTS, 0, size.width * size.height);
        glDisable(GL_PROGRAM_POINT_SIZE);
        if (kept) kept->drawn[KeptPicture::caustics] = true;
    });
    return light;
}

}  // namespace rivulet
