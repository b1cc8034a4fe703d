#include "fluid/session/surface_probe.h"

#include <algorithm>
#include <utility>

#include "engine/render/passes.h"

namespace rivulet {

Result<SurfaceProbe> SurfaceProbe::create(bool ownContext) {
    SurfaceProbe probe;
    if (ownContext) {
        Result<ContextEgl> context = ContextEgl::create();
        if (!context) return context.error();
        probe.context_ = std::move(*context);
    }
    Result<FluidPrograms> programs = FluidPrograms::create(ShaderFiles::developer());
    if (!programs) return programs.error();
    probe.programs_ = std::move(*programs);
    return probe;
}

namespace {
// Radiance behind the water, far above that of water which lets no light through (about 1): a pixel shows which share of it is left.
constexpr float kBehind = 1000;
constexpr float kBlack = 1.0e6F;  // 1/m: e^-10 is left after 0.01 mm
}  // namespace

Result<SurfaceSeen> SurfaceProbe::see(std::span<const vec4> particles, FluidView fluid, const FrameView& view, const FluidLook& look,
                                      const HostEllipsoids& ellipsoids) {
    const FrameParams frame = packFrame(view, {}, {}, {});
    Result<gpu::Buffer> block = gpu::Buffer::from(std::vector<FrameParams>{frame});
    if (!block) return block.error();
    Result<gpu::Buffer> coarse = gpu::Buffer::from(std::vector<FrameParams>{packFrame(view.half(), {}, {}, {})});
    if (!coarse) return coarse.error();
    Result<gpu::Buffer> position = gpu::Buffer::from(std::vector<vec4>(particles.begin(), particles.end()));
    if (!position) return position.error();
    Result<gpu::Texture> colour = gpu::Texture::create({.width = view.width, .height = view.height, .format = gpu::Format::rgba16f});
    if (!colour) return colour.error();
    Result<gpu::Texture> window = gpu::Texture::create({.width = view.width, .height = view.height, .format = gpu::Format::depth32f});
    if (!window) return window.error();
    colour->clear(vec4(kBehind));
    window->clear(vec4(1.0F));
    gpu::TransientPool pool;
    gpu::FrameGraph graph(pool);
    FluidDraw d;
    d.view = view;
    d.look = look;
    d.look.absorption = vec3(kBlack);
    d.look.scattering = vec3(0.0F);
    d.fluid = std::move(fluid);
    d.fluid.position = d.fluid.velocity = d.fluid.id = position->name();
    d.fluid.count = static_cast<uint32_t>(particles.size());
    d.frame = graph.importBuffer("frame", block->name(), block->bytes());
    d.coarse = graph.importBuffer("coarse frame", coarse->name(), coarse->bytes());
    d.position = graph.importBuffer("positions", position->name(), position->bytes());
    std::array<gpu::Buffer, 3> about;
    for (size_t k = 0; k < 3 && !ellipsoids[0].empty(); ++k) {
        Result<gpu::Buffer> buffer = gpu::Buffer::from(ellipsoids[k]);
        if (!buffer) return buffer.error();
        about[k] = std::move(*buffer);
        d.fluid.ellipsoids[k] = about[k].name();
        d.ellipsoids.push_back(graph.importBuffer("ellipsoids", about[k].name(), about[k].bytes()));
    }
    d.colour = graph.importTexture("colour", *colour);
    d.depth = graph.importTexture("depth", *window);
    d.shadowSharp = d.shadowSoft = graph.importTexture("nothing", *colour);
    const FluidLayers layers = addScreenSpace(graph, programs_, d);
    graph.output(layers.fluidDepth);
    graph.output(layers.colour);
    if (Status ran = graph.execute(); !ran) return ran.error();
    const size_t pixels = static_cast<size_t>(view.width) * static_cast<size_t>(view.height);
    SurfaceSeen seen{std::vector<float>(pixels), std::vector<float>(pixels)};
    graph.result(layers.fluidDepth).read(std::as_writable_bytes(std::span(seen.depth)));
    std::vector<vec4> radiance(pixels);
    graph.result(layers.colour).read(std::as_writable_bytes(std::span(radiance)));
    for (size_t i = 0; i < pixels; ++i) seen.cover[i] = std::clamp(1 - radiance[i].y / kBehind, 0.0F, 1.0F);
    return seen;
}

}  // namespace rivulet
