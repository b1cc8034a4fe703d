#include "fluid/capi/host_renderer.h"

#include <fmt/format.h>

#include <cstring>
#include <exception>
#include <vector>

#include "engine/gpu/host_state.h"
#include "fluid/capi/drawing.h"

namespace rivulet::capi {

Result<HostRenderer> HostRenderer::of(const rivulet_renderer& host, const RendererRow& ours) {
    if (host.stage != RIVULET_INSTEAD && host.stage != RIVULET_AFTER)
        return badInput(fmt::format("renderer.stage is {}: use RIVULET_INSTEAD or RIVULET_AFTER", host.stage));
    if (host.draw == nullptr) return badInput("renderer.draw is NULL: give a function, or set view.renderer to NULL");
    HostRenderer made;
    made.host_ = host;
    made.ours_ = &ours;
    return made;
}

RendererRow HostRenderer::row() {
    const bool after = host_.stage == RIVULET_AFTER;
    return {.name = "host",
            .doc = "a host's own renderer",
            .opaque = !after || ours_->opaque,
            .add = add,
            .ellipsoids = after && ours_->ellipsoids,
            .user = this};
}

FluidLayers HostRenderer::add(gpu::FrameGraph& graph, FluidPrograms& programs, const FluidDraw& d) {
    auto& self = *static_cast<HostRenderer*>(d.user);
    FluidLayers layers{d.colour, {}};
    gpu::TextureHandle depth = d.depth;
    if (self.host_.stage == RIVULET_AFTER) {
        layers = self.ours_->add(graph, programs, d);
        depth = addSceneAndWaterDepth(graph, programs, d, layers);
        if (!self.ours_->opaque) {  // without particles, the picture is the scene's own
            const gpu::TextureHandle colour = graph.texture("after the water", graph.desc(layers.colour));
            copyTexels(graph, "copy water", layers.colour, colour);
            layers.colour = colour;
        }
    }
    std::vector<gpu::Read> reads = {{depth, gpu::Usage::target}};
    for (const gpu::BufferHandle buffer : {d.position, d.velocity, d.id})
        if (buffer)
            for (const gpu::Usage usage : {gpu::Usage::attribute, gpu::Usage::storage, gpu::Usage::sampled})
                reads.emplace_back(buffer, usage);
    graph.pass("host's renderer", reads, {layers.colour, depth}, [&self, d, colour = layers.colour, depth](gpu::PassContext& c) {
        const gpu::Framebuffer& target = c.drawTo({colour}, depth);
        c.state({});
        const gpu::HostState keep(gpu::HostState::everything);
        self.call(d, target.name());
    });
    return layers;
}

void HostRenderer::call(const FluidDraw& d, unsigned framebuffer) {
    rivulet_buffers particles = buffersOf(d.fluid);
    particles.size = sizeof particles;
    rivulet_drawing drawing{};
    drawing.size = sizeof drawing;
    drawing.particles = &particles;
    std::memcpy(drawing.view, &d.view.view[0][0], sizeof drawing.view);
    std::memcpy(drawing.projection, &d.view.projection[0][0], sizeof drawing.projection);
    drawing.near_plane = d.view.nearPlane;
    drawing.far_plane = d.view.farPlane;
    drawing.width = d.view.width;
    drawing.height = d.view.height;
    drawing.framebuffer = framebuffer;
    try {
        host_.draw(host_.user, &drawing);
    } catch (const std::exception& e) {
        thrown_ = fmt::format("renderer.draw threw an exception: {}", e.what());
    } catch (...) {
        thrown_ = "renderer.draw threw an exception";
    }
}

Status HostRenderer::outcome() const {
    if (!thrown_.empty()) return failed(thrown_);
    return ok();
}

}  // namespace rivulet::capi
