// The truth as a renderer: the iso-surface of the particles (Yu & Turk 2013), ray-marched on the host, in the light of the others.
#include <cstddef>

#include "fluid/render/raymarch.h"
#include "fluid/render/renderers.h"

namespace rivulet {
namespace {

using gpu::Format;
using gpu::PassContext;
using gpu::TextureHandle;
using gpu::Usage;

template <class T>
void upload(const gpu::Texture& to, const std::vector<T>& texels) {
    const gpu::FormatInfo& format = gpu::formatInfo(to.desc().format);
    glTextureSubImage2D(to.name(), 0, 0, 0, to.width(), to.height(), format.layout, format.type, texels.data());
}

// Along the view axis, m, from window depth; see frame.glsl.
std::vector<float> sceneDepths(const gpu::Texture& window, const FrameView& view) {
    std::vector<float> depths(static_cast<size_t>(window.width()) * static_cast<size_t>(window.height()));
    window.read(std::as_writable_bytes(std::span(depths)));
    const float a = view.projection[2][2], b = view.projection[3][2];
    for (float& z : depths) z = b / (2 * z - 1 + a);
    return depths;
}

}  // namespace

FluidLayers addTruth(gpu::FrameGraph& graph, FluidPrograms& programs, const FluidDraw& d) {
    if (d.fluid.count == 0) return {d.colour, {}};
    gpu::TextureDesc size{.width = d.view.width, .height = d.view.height, .format = Format::r32f};
    // Spray and dye are matters of particles, not of their surface.
    WaterSurface water = addThickness(graph, programs, d, addTiles(graph, programs, d));
    water.depth = graph.texture("truth depth", size);
    size.format = Format::rgba32f;
    water.normals = graph.texture("truth normals", size);
    water.tiles = graph.texture("all tiles", {.width = 1, .height = 1, .format = Format::r8});
    graph.pass("all tiles", {}, {water.tiles}, [=](PassContext& c) { c.drawTo({water.tiles}).clearColour(vec4(1.0F)); });
    graph.pass(
        "truth", {{d.position, Usage::copy}, {d.depth, Usage::copy}}, {{water.depth, Usage::copy}, {water.normals, Usage::copy}},
        [=](PassContext& c) {
            std::vector<vec4> particles(d.fluid.count);
            glGetNamedBufferSubData(c.buffer(d.position), 0, static_cast<GLsizeiptr>(particles.size() * sizeof(vec4)), particles.data());
            const Result<IsoSurface> surface = IsoSurface::create(particles, d.fluid.spacing);
            ASSERT(surface, "a FluidView has a spacing of more than 0");
            const std::vector<float> until = sceneDepths(c.texture(d.depth), d.view);
            const RaymarchPicture picture = raymarch(*surface, d.view, {.box = d.fluid.bounds, .until = until, .progress = d.progress});
            upload(c.texture(water.depth), picture.depth);
            upload(c.texture(water.normals), picture.water);
        });
    return addShade(graph, programs, d, water);
}

}  // namespace rivulet
